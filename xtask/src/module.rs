//! The WebAssembly modules, with the JavaScript that calls them.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};
use flate2::Compression;
use flate2::write::GzEncoder;
use wasm_bindgen_cli_support::Bindgen;

use crate::{root, split};

const TARGET: &str = "wasm32-unknown-unknown";

/// What several threads need: instructions for memory that they share, at most 4 GiB, which comes from the first of them, and
/// what the others begin with.
const SHARED: [&str; 9] = [
    "-Ctarget-feature=+atomics",
    "-Clink-arg=--shared-memory",
    "-Clink-arg=--import-memory",
    "-Clink-arg=--max-memory=4294967296",
    "-Clink-arg=--export=__heap_base",
    "-Clink-arg=--export=__wasm_init_tls",
    "-Clink-arg=--export=__tls_size",
    "-Clink-arg=--export=__tls_align",
    "-Clink-arg=--export=__tls_base",
];

/// The modules as files by name: for one thread `pathwright.js`, `pathwright_bg.wasm` and `pathwright_rest.wasm`, for several those of
/// `pathwright-threads`. Where there is a `wasm-opt` (binaryen), they are made smaller and quicker by that.
pub fn build() -> Result<Vec<(String, Vec<u8>)>> {
    let mut files = Vec::new();
    for (name, is_shared) in [("pathwright", false), ("pathwright-threads", true)] {
        let out = target().join("web-module");
        let mut bindgen = Bindgen::new();
        bindgen.input_path(compile(is_shared)?).out_name(name).web(true)?.typescript(false);
        bindgen.omit_default_module_path(true).remove_name_section(true).remove_producers_section(true);
        bindgen.generate(&out)?;
        let [script, main, rest] =
            [format!("{name}.js"), format!("{name}_bg.wasm"), format!("{name}_rest.wasm")];
        optimise(&out.join(&main))?;
        divide(&out, [&script, &main, &rest])?;
        // Again, for the calls of the rest.
        optimise(&out.join(&main))?;
        for file in [script, main, rest] {
            let path = out.join(&file);
            let bytes = fs::read(&path).with_context(|| path.display().to_string())?;
            println!("{file}: {} bytes, {} gzipped", bytes.len(), gzipped(&bytes)?);
            files.push((file, bytes));
        }
    }
    Ok(files)
}

fn target() -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from)
}

/// Compiles the module. The standard library that comes with Rust is for one thread, and quick rather than small: its sorts alone are
/// a tenth of the module. So it is compiled from its sources, which stable Rust does not do unless it is told to by `RUSTC_BOOTSTRAP`.
fn compile(is_shared: bool) -> Result<PathBuf> {
    let folder = if is_shared { target().join("web-threads") } else { target() };
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command.args(["build", "--locked", "-p", "pathwright-wasm", "--profile", "web", "--target", TARGET]);
    command.arg("--target-dir").arg(&folder).current_dir(root());
    command.args(["-Zbuild-std=std,panic_abort", "-Zbuild-std-features=optimize_for_size"]);
    command.env("RUSTC_BOOTSTRAP", "1");
    if is_shared {
        // What comes before all other ways to give flags.
        command.env("CARGO_ENCODED_RUSTFLAGS", SHARED.join("\x1f"));
    }
    if !command.status()?.success() {
        bail!(
            "the module was not built; what it needs is added by `rustup target add {TARGET}` and `rustup component add rust-src`"
        );
    }
    Ok(folder.join(TARGET).join("web/pathwright_wasm.wasm"))
}

fn optimise(file: &Path) -> Result<()> {
    let program = std::env::var_os("WASM_OPT").unwrap_or_else(|| "wasm-opt".into());
    let features = ["--enable-bulk-memory", "--enable-nontrapping-float-to-int", "--enable-sign-ext"];
    let more =
        ["--enable-mutable-globals", "--enable-multivalue", "--enable-reference-types", "--enable-threads"];
    let run =
        Command::new(program).args(["-O3"]).args(features).args(more).arg(file).arg("-o").arg(file).status();
    match run {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => bail!("wasm-opt ends with {status}"),
        Err(_) => {
            println!(
                "there is no wasm-opt (npm package binaryen; or WASM_OPT names it): the module is left as it is"
            );
            Ok(())
        }
    }
}

/// Leaves in the module what prints call as a rule; what that is, is found out by slicing in Node.
fn divide(folder: &Path, [script, main, rest]: [&str; 3]) -> Result<()> {
    let [script, main, rest] = [folder.join(script), folder.join(main), folder.join(rest)];
    let [marking, marks] = [main.with_extension("marking.wasm"), main.with_extension("marks")];
    let bytes = fs::read(&main)?;
    fs::write(&marking, split::marking(&bytes)?)?;
    fs::write(folder.join("package.json"), "{ \"type\": \"module\" }\n")?;
    let mut node = Command::new("node");
    node.arg(root().join("xtask/marks.mjs")).args([&script, &marking, &root().join("models"), &marks]);
    let marks = match node.arg(split::MARKS.to_string()).status() {
        Ok(status) if status.success() => fs::read(marks)?,
        Ok(status) => bail!("marking what is called ends with {status}"),
        Err(_) => {
            println!("there is no node: the module is left whole");
            vec![1; split::MARKS]
        }
    };
    let parts = split::split(&bytes, &marks)?;
    for (path, bytes) in [main, rest].iter().zip(parts) {
        fs::write(path, bytes)?;
    }
    Ok(())
}

fn gzipped(bytes: &[u8]) -> Result<usize> {
    let mut packed = GzEncoder::new(Vec::new(), Compression::best());
    packed.write_all(bytes)?;
    Ok(packed.finish()?.len())
}
