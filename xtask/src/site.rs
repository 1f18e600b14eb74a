//! The page as static files, which any host serves.

use std::borrow::Cow;
use std::fs;
use std::path::Path;

use anyhow::Result;
use pathwright::serve::{page_files, page_index};
use sha2::{Digest, Sha256};

use crate::{module, root};

/// The page may load what is beside it and nothing else; `policy.js` says whom it may ask.
const POLICY: &str = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; worker-src 'self' blob:; \
    connect-src 'self' http: https:; img-src 'self' data: blob:; form-action 'none'; base-uri 'none'";

/// Makes it.
pub fn make(folder: &Path) -> Result<()> {
    let mut files: Vec<(String, Cow<'static, [u8]>)> =
        page_files().into_iter().map(|(name, text)| (name.to_owned(), into_bytes(text))).collect();
    for (from, name) in [
        ("web", "host-worker.js"),
        ("web", "hosts.js"),
        ("web", "kept.js"),
        ("web", "local.js"),
        ("web", "policy.js"),
        ("bindings/npm", "browser.js"),
        ("bindings/npm", "caller.js"),
        ("bindings/npm", "rest.js"),
        ("bindings/npm", "slicer.js"),
        ("bindings/npm", "worker.js"),
    ] {
        files.push((name.to_owned(), fs::read(root().join(from).join(name))?.into()));
    }
    files.extend(module::build()?.into_iter().map(|(name, bytes)| (name, bytes.into())));

    // Below an address that changes with them, so that no cache mixes two versions.
    let worker = fs::read_to_string(root().join("web/service-worker.js"))?;
    let policy = format!("<meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\">");
    let first = format!("{policy}\n<script src=\"{{{{assets}}}}/policy.js\"></script>\n<title>");
    let page = page_index("{{assets}}", "worker").replace("<title>", &first);
    let mut hasher = Sha256::new();
    for (name, bytes) in &files {
        hasher.update(name);
        hasher.update(bytes);
    }
    hasher.update(&page);
    hasher.update(&worker);
    let version: String = hasher.finalize().iter().take(8).map(|byte| format!("{byte:02x}")).collect();
    let assets = format!("assets/{version}");

    let all = folder.join("assets");
    if all.exists() {
        fs::remove_dir_all(all)?;
    }
    for (name, bytes) in &files {
        let path = folder.join(&assets).join(name);
        fs::create_dir_all(path.parent().unwrap_or(folder))?;
        fs::write(path, bytes)?;
    }
    let list: Vec<String> = files.iter().map(|(name, _)| format!("  \"{assets}/{name}\",\n")).collect();
    let worker = worker.replace("{{version}}", &version).replace("/* {{files}} */", &list.concat());
    fs::write(folder.join("service-worker.js"), worker)?;
    fs::write(folder.join("index.html"), page.replace("{{assets}}", &assets))?;
    println!("site: {}", folder.display());
    Ok(())
}

fn into_bytes(text: Cow<'static, str>) -> Cow<'static, [u8]> {
    match text {
        Cow::Borrowed(text) => Cow::Borrowed(text.as_bytes()),
        Cow::Owned(text) => Cow::Owned(text.into_bytes()),
    }
}
