//! Tells the linker to write the program as Linux maps it fastest (docs/speed.md).

use std::path::Path;
use std::process::{Command, Stdio};
use std::{env, fs};

/// Segments lie at multiples of 2 MB, in memory as in the file, none in a page with another, and the file is written at once: then it
/// lies in memory in pages of 2 MB, and is mapped so. LLD 21 and 22 write at once what they are told to map:
/// <https://github.com/llvm/llvm-project/issues/207459>.
const LINKER_ARGUMENTS: [&str; 3] =
    ["-Wl,-z,max-page-size=0x200000", "-Wl,-z,separate-loadable-segments", "-Wl,--mmap-output-file"];

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    let is = |variable, value| env::var(variable).is_ok_and(|of| of == value);
    if is("PROFILE", "release") && is("CARGO_CFG_TARGET_OS", "linux") && linker_takes_them() {
        for argument in LINKER_ARGUMENTS {
            println!("cargo:rustc-link-arg-bins={argument}");
        }
    }
}

/// Whether an empty program can be linked so: not every linker knows all.
fn linker_takes_them() -> bool {
    let of = |variable| env::var(variable).unwrap_or_default();
    let (out, source) = (of("OUT_DIR"), Path::new(&of("OUT_DIR")).join("empty.rs"));
    if fs::write(&source, "fn main() {}").is_err() {
        return false;
    }
    let mut rustc = Command::new(of("RUSTC"));
    rustc.arg(source).args(["--target", &of("TARGET"), "--out-dir", &out]);
    rustc.args(of("CARGO_ENCODED_RUSTFLAGS").split('\x1f').filter(|flag| !flag.is_empty()));
    if let Ok(linker) = env::var("RUSTC_LINKER") {
        rustc.arg(format!("-Clinker={linker}"));
    }
    rustc.args(LINKER_ARGUMENTS.map(|argument| format!("-Clink-arg={argument}")));
    rustc.stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok_and(|status| status.success())
}
