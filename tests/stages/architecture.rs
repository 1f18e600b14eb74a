//! Imports point one way: a module uses only those that come before it in the way of the data.

use std::fs;
use std::path::{Path, PathBuf};

/// The modules of the crate, each before those that may use it.
const ORDER: &[&str] = &[
    "units", "options", "limits", "observer", "parallel", "source", "mesh", "plate", "slice", "toolpath",
    "order", "motion", "estimate", "gcode", "profile", "reorder", "report", "check", "view", "output", "job",
    "plan", "pipeline", "cli",
];

fn sources(folder: &Path, out: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        match path.is_dir() {
            true => sources(&path, out),
            false => out.push(path),
        }
    }
}

/// Names after `crate::` in code; what tests use does not count.
fn imports(text: &str) -> impl Iterator<Item = &str> {
    let code = text.split("#[cfg(test)]\nmod tests").next().unwrap_or_default();
    let lines = code.lines().filter(|line| !line.trim_start().starts_with("//"));
    lines.flat_map(|line| line.split("crate::").skip(1)).filter_map(|rest| {
        let name = rest.split(|c: char| !(c.is_alphanumeric() || c == '_')).next()?;
        (!name.is_empty()).then_some(name)
    })
}

#[test]
fn imports_point_one_way() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    sources(&root, &mut files);
    let rank = |module: &str| ORDER.iter().position(|known| *known == module);
    let mut wrong = Vec::new();
    for file in files {
        let inside = file.strip_prefix(&root).unwrap();
        let module = inside.iter().next().unwrap().to_str().unwrap().trim_end_matches(".rs");
        if matches!(module, "lib" | "main") {
            continue;
        }
        let own = rank(module)
            .unwrap_or_else(|| panic!("{}: give the module its place in ORDER", inside.display()));
        let text = fs::read_to_string(&file).unwrap();
        for import in imports(&text) {
            if rank(import).is_some_and(|used| used > own) {
                wrong.push(format!("{} uses {import}", inside.display()));
            }
        }
    }
    assert_eq!(wrong, Vec::<String>::new());
}

#[test]
fn no_other_program_is_ever_started() {
    let mut files = Vec::new();
    sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), &mut files);
    for file in files {
        let text = fs::read_to_string(&file).unwrap();
        let code = text.split("#[cfg(test)]\nmod tests").next().unwrap_or_default();
        assert!(!code.contains("process::Command") && !code.contains("Command::new("), "{}", file.display());
    }
}
