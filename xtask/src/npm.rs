//! The npm package as a folder.

use std::fs;
use std::path::Path;

use anyhow::Result;

use crate::{module, root};

/// What is in it beside the modules.
const FILES: [&str; 11] = [
    "README.md",
    "browser.js",
    "caller.js",
    "index.d.ts",
    "index.js",
    "node-worker.js",
    "node.js",
    "package.json",
    "rest.js",
    "slicer.js",
    "worker.js",
];

/// Makes it.
pub fn make(folder: &Path) -> Result<()> {
    let modules = module::build()?;
    fs::create_dir_all(folder)?;
    for name in FILES {
        fs::copy(root().join("bindings/npm").join(name), folder.join(name))?;
    }
    for name in ["LICENSE-APACHE", "LICENSE-MIT"] {
        fs::copy(root().join(name), folder.join(name))?;
    }
    for (name, bytes) in modules {
        fs::write(folder.join(name), bytes)?;
    }
    println!("npm package: {}; `npm pack` packs it", folder.display());
    Ok(())
}
