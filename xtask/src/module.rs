//! The WebAssembly module, with the JavaScript that calls it.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};
use flate2::Compression;
use flate2::write::GzEncoder;
use wasm_bindgen_cli_support::Bindgen;

use crate::root;

const TARGET: &str = "wasm32-unknown-unknown";

/// `pathwright.js` and `pathwright_bg.wasm`.
pub struct Module {
    pub script: Vec<u8>,
    pub wasm: Vec<u8>,
}

/// Builds the module. Where there is a `wasm-opt` (binaryen), it is made smaller and quicker by that.
pub fn build() -> Result<Module> {
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from);
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let built = Command::new(cargo)
        .args(["build", "--locked", "-p", "pathwright-wasm", "--profile", "web", "--target", TARGET])
        .current_dir(root())
        .status()?;
    if !built.success() {
        bail!("the module was not built; its target is added by `rustup target add {TARGET}`");
    }
    let out = target.join("web-module");
    let input = target.join(TARGET).join("web/pathwright_wasm.wasm");
    let mut bindgen = Bindgen::new();
    bindgen.input_path(input).out_name("pathwright").web(true)?.typescript(false);
    bindgen.omit_default_module_path(true).remove_name_section(true).remove_producers_section(true);
    bindgen.generate(&out)?;
    let file = out.join("pathwright_bg.wasm");
    optimise(&file)?;
    let read = |path: &Path| fs::read(path).with_context(|| path.display().to_string());
    let module = Module { script: read(&out.join("pathwright.js"))?, wasm: read(&file)? };
    println!("module: {} bytes, {} gzipped", module.wasm.len(), gzipped(&module.wasm)?);
    Ok(module)
}

fn optimise(file: &Path) -> Result<()> {
    let program = std::env::var_os("WASM_OPT").unwrap_or_else(|| "wasm-opt".into());
    let features = ["--enable-bulk-memory", "--enable-nontrapping-float-to-int", "--enable-sign-ext"];
    let more = ["--enable-mutable-globals", "--enable-multivalue", "--enable-reference-types"];
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

fn gzipped(bytes: &[u8]) -> Result<usize> {
    let mut packed = GzEncoder::new(Vec::new(), Compression::best());
    packed.write_all(bytes)?;
    Ok(packed.finish()?.len())
}
