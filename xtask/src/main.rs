//! Makes the static site and the npm package: `cargo run -p xtask -- site`, `cargo run -p xtask -- npm`.

mod module;
mod npm;
mod site;
mod split;

use std::path::{Path, PathBuf};

use anyhow::{Result, bail};

fn main() -> Result<()> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    match words[..] {
        ["site"] => site::make(&root().join("dist")),
        ["site", folder] => site::make(Path::new(folder)),
        ["npm"] => npm::make(&root().join("target/npm")),
        ["npm", folder] => npm::make(Path::new(folder)),
        _ => bail!(
            "cargo run -p xtask -- site [FOLDER]   the page as static files, in dist/\n\
             cargo run -p xtask -- npm [FOLDER]    the npm package, to be packed, in target/npm/"
        ),
    }
}

/// The project's folder.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}
