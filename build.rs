//! Parses the embedded profiles, and tells the linker to write the program as Linux maps it fastest (docs/speed.md).

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::{env, fs};

use toml::{Table, Value};

/// Segments lie at multiples of 2 MB, in memory as in the file, none in a page with another, and the file is written at once: then it
/// lies in memory in pages of 2 MB, and is mapped so. LLD 21 and 22 write at once what they are told to map:
/// <https://github.com/llvm/llvm-project/issues/207459>.
const SEGMENTS: [&str; 3] =
    ["-Wl,-z,max-page-size=0x200000", "-Wl,-z,separate-loadable-segments", "-Wl,--mmap-output-file"];
/// What unwinds is part of the program: as a library of its own it takes a fiftieth of a small model's time to be loaded. The standard
/// library asks for that library by name, and finds this. Not beside HiGHS: what C++ brings loads that library anyway.
const UNWINDER: [&str; 2] = ["libgcc_s.so", "INPUT(-lgcc_eh -lgcc)\n"];

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    write_profiles();
    if variable("PROFILE") == "release" && variable("CARGO_CFG_TARGET_OS") == "linux" {
        link_with(&SEGMENTS);
        if env::var_os("CARGO_FEATURE_HIGHS").is_none() {
            let folder = PathBuf::from(variable("OUT_DIR")).join("unwinder");
            let [name, text] = UNWINDER;
            fs::create_dir_all(&folder).expect("a folder");
            fs::write(folder.join(name), text).expect("the unwinder's name, written");
            link_with(&[&format!("-L{}", folder.display())]);
        }
    }
}

fn variable(of: &str) -> String {
    env::var(of).unwrap_or_default()
}

/// Writes the values of each profile as statics, by name, for `src/profile/embedded.rs`: text would be parsed in each run.
fn write_profiles() {
    println!("cargo:rerun-if-changed=profiles");
    let mut code = String::from("static TABLES: &[(&str, &[(&str, Written)])] = &[");
    for path in toml_files("profiles") {
        let text = fs::read_to_string(&path).expect("a text");
        let table: Table = text.parse().unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        let _ = write!(code, "\n    ({name:?}, {}),", entries(&table));
    }
    code.push_str("\n];\n");
    fs::write(Path::new(&variable("OUT_DIR")).join("profiles.rs"), code).expect("the profiles, written");
}

/// The TOML files of a folder by name.
fn toml_files(folder: &str) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("a folder");
    let mut paths: Vec<_> = entries.map(|entry| entry.expect("a file").path()).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "toml"));
    paths.sort();
    paths
}

fn entries(table: &Table) -> String {
    let entries = table.iter().map(|(key, value)| format!("({key:?}, {})", written(value)));
    format!("&[{}]", entries.collect::<Vec<_>>().join(", "))
}

fn written(value: &Value) -> String {
    match value {
        Value::String(text) => format!("Written::Text({text:?})"),
        Value::Integer(number) => format!("Written::Integer({number})"),
        Value::Float(number) => format!("Written::Float({number:?})"),
        Value::Boolean(truth) => format!("Written::Boolean({truth})"),
        Value::Array(list) => {
            format!("Written::List(&[{}])", list.iter().map(written).collect::<Vec<_>>().join(", "))
        }
        Value::Table(table) => format!("Written::Table({})", entries(table)),
        Value::Datetime(date) => panic!("no setting is a date, such as {date}"),
    }
}

/// Has the program linked so, if the linker can.
fn link_with(arguments: &[&str]) {
    if linker_takes(arguments) {
        arguments.iter().for_each(|argument| println!("cargo:rustc-link-arg-bins={argument}"));
    }
}

/// Whether an empty program can be linked so: not every linker knows all.
fn linker_takes(arguments: &[&str]) -> bool {
    let (out, source) = (variable("OUT_DIR"), Path::new(&variable("OUT_DIR")).join("empty.rs"));
    if fs::write(&source, "fn main() {}").is_err() {
        return false;
    }
    let mut rustc = Command::new(variable("RUSTC"));
    rustc.arg(source).args(["--target", &variable("TARGET"), "--out-dir", &out]);
    rustc.args(variable("CARGO_ENCODED_RUSTFLAGS").split('\x1f').filter(|flag| !flag.is_empty()));
    if let Ok(linker) = env::var("RUSTC_LINKER") {
        rustc.arg(format!("-Clinker={linker}"));
    }
    rustc.args(arguments.iter().map(|argument| format!("-Clink-arg={argument}")));
    rustc.stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok_and(|status| status.success())
}
