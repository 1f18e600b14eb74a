//! The page at `/`: its files, below an address that changes with them.

use std::borrow::Cow;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::LazyLock;

use crate::view;

const INDEX: &str = include_str!("page/index.html");

macro_rules! files {
    ($($path:literal)*) => { &[$(($path, include_str!(concat!("page/", $path)))),*] };
}

/// All but the parts that it shares with the page of `pathwright view`.
const FILES: &[(&str, &str)] = files![
    "app.js" "connection.js" "desk.js" "engine.js" "geometry.js" "icon.svg" "memory.js" "project.js"
    "css/centre.css" "css/page.css" "css/panels.css"
    "plate/draw.js" "plate/gizmo.js" "plate/instances.js" "plate/pointer.js" "plate/shaders.js" "plate/view.js"
    "preview/compare.js" "preview/follow.js" "preview/preview.js" "preview/stops.js" "preview/worker.js"
    "settings/combo.js" "settings/field.js" "settings/folders.js" "settings/panel.js" "settings/presets.js"
    "ui/adding-host.js" "ui/bodies.js" "ui/files.js" "ui/hosts.js" "ui/keyboard.js" "ui/login.js" "ui/notices.js" "ui/objects.js" "ui/status.js" "ui/transform.js" "ui/warnings.js"
];

/// The shared parts as one module.
static PARTS: LazyLock<String> = LazyLock::new(view::parts_module);

/// What tells these files from those of another version.
static VERSION: LazyLock<String> = LazyLock::new(|| {
    let mut hasher = DefaultHasher::new();
    (INDEX, FILES, PARTS.as_str(), view::parts_style()).hash(&mut hasher);
    format!("{:016x}", hasher.finish())
});

/// A file of the page. It never changes at its address.
pub(super) struct Asset {
    pub content_type: &'static str,
    pub bytes: Cow<'static, [u8]>,
}

/// The page itself.
pub(super) fn index() -> String {
    page_index(&format!("/assets/{}", *VERSION), "service")
}

/// The page at `/` for whoever serves it: where its files are, and what slices: `service`, or `worker` of the page's own.
pub fn page_index(assets: &str, engine: &str) -> String {
    INDEX.replace("{{assets}}", assets).replace("{{engine}}", engine)
}

/// All files of the page, by their names beneath where they are.
pub fn page_files() -> Vec<(&'static str, Cow<'static, str>)> {
    let shared =
        [("view.js", Cow::Borrowed(PARTS.as_str())), ("parts.css", Cow::Borrowed(view::parts_style()))];
    shared.into_iter().chain(FILES.iter().map(|&(name, text)| (name, text.into()))).collect()
}

/// The file at `/assets/{path}`.
pub(super) fn asset(path: &str) -> Option<Asset> {
    let name = path.strip_prefix(VERSION.as_str())?.strip_prefix('/')?;
    let text = match name {
        "view.js" => PARTS.as_str(),
        "parts.css" => view::parts_style(),
        _ => FILES.iter().find(|(known, _)| *known == name)?.1,
    };
    let content_type = match name.rsplit_once('.')?.1 {
        "js" => "text/javascript; charset=utf-8",
        "css" => "text/css; charset=utf-8",
        _ => "image/svg+xml",
    };
    Some(Asset { content_type, bytes: Cow::Borrowed(text.as_bytes()) })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What comes after each `from "` or `href="{{assets}}/` and the like.
    fn named<'a>(text: &'a str, before: &'a str, after: char) -> impl Iterator<Item = &'a str> {
        text.split(before).skip(1).filter_map(move |rest| rest.split(after).next())
    }

    fn exists(name: &str) -> bool {
        asset(&format!("{}/{name}", *VERSION)).is_some()
    }

    #[test]
    fn whatever_the_page_names_is_there() {
        for name in named(INDEX, "\"{{assets}}/", '"') {
            assert!(exists(name), "{name}");
        }
        for (path, text) in FILES.iter().filter(|(path, _)| path.ends_with(".js")) {
            let folder = path.rsplit_once('/').map(|(folder, _)| folder);
            for import in named(text, " from \"", '"') {
                let name = match (import.strip_prefix("./"), import.strip_prefix("../")) {
                    (Some(beside), _) => {
                        folder.map_or(beside.to_owned(), |folder| format!("{folder}/{beside}"))
                    }
                    (_, Some(above)) => above.to_owned(),
                    _ => panic!("{path}: {import} is from elsewhere"),
                };
                assert!(exists(&name), "{path}: {import}");
            }
        }
    }

    #[test]
    fn the_page_holds_no_script_or_style_of_its_own() {
        let page = index();
        assert!(!page.contains("{{") && !page.contains("style=") && !page.contains("<style"));
        let is_listener =
            |rest: &str| rest.trim_start_matches(|c: char| c.is_ascii_lowercase()).starts_with('=');
        assert!(!page.split(" on").skip(1).any(is_listener), "{page}");
        assert!(!page.contains("https://") && !page.contains("http://"), "{page}");
    }
}
