//! Imports point in one direction: between the modules of the library, and between the files of each crate.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The modules of the library, each before those that may use it.
const ORDER: &[&str] = &[
    "units", "options", "limits", "near", "observer", "parallel", "mesh", "plate", "slice", "toolpath",
    "order", "motion", "estimate", "gcode", "presets", "profile", "reorder", "report", "check", "view",
    "output", "job", "source", "plan", "pipeline", "api", "system", "live", "send", "serve", "cli",
];

/// The sources of all crates that are there: a packaged crate has its own alone.
fn crates() -> impl Iterator<Item = PathBuf> {
    let folders = [
        "src",
        "crates/bgcode/src",
        "crates/geometry/src",
        "crates/macros/src",
        "crates/ordering/src",
        "crates/wasm/src",
    ];
    folders.into_iter().map(|folder| root().join(folder)).filter(|folder| folder.exists())
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn sources(folder: &Path, out: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        match path.is_dir() {
            true => sources(&path, out),
            false => out.push(path),
        }
    }
}

/// A file's code without comments and texts; what tests use does not count.
fn code(path: &Path) -> String {
    let text = fs::read_to_string(path).unwrap();
    let text = text.split("mod tests {").next().unwrap_or_default();
    let lines = text.lines().map(|line| line.split("//").next().unwrap_or_default());
    lines.filter(|line| !line.trim_start().starts_with("#[")).collect::<Vec<_>>().join("\n")
}

/// A module's path within its crate: `mesh::repair`.
type Module = Vec<String>;

/// Every file of a crate by its module.
fn modules(folder: &Path) -> BTreeMap<Module, String> {
    let mut files = Vec::new();
    sources(folder, &mut files);
    let module = |path: &PathBuf| {
        let inside = path.strip_prefix(folder).unwrap().with_extension("");
        let mut names: Module = inside.iter().map(|name| name.to_string_lossy().into_owned()).collect();
        if names.last().is_some_and(|last| matches!(last.as_str(), "mod" | "lib" | "main")) {
            names.pop();
        }
        names
    };
    let is_module =
        |path: &&PathBuf| path.extension().is_some_and(|ending| ending == "rs") && !path.ends_with("main.rs");
    files.iter().filter(is_module).map(|path| (module(path), code(path))).collect()
}

/// The paths that a `use` names: `a::{b, c::d}` is `a::b` and `a::c::d`.
fn named(tree: &str) -> Vec<String> {
    let tree = tree.trim();
    let Some(open) = tree.find('{') else {
        return vec![tree.split(" as ").next().unwrap_or_default().trim().to_owned()];
    };
    let (mut depth, mut parts) = (0, vec![String::new()]);
    for c in tree[open + 1..].strip_suffix('}').unwrap_or_default().chars() {
        depth += i32::from(c == '{') - i32::from(c == '}');
        match c {
            ',' if depth == 0 => parts.push(String::new()),
            c => parts.last_mut().unwrap().push(c),
        }
    }
    let parts = parts.iter().filter(|part| !part.trim().is_empty());
    parts.flat_map(|part| named(part)).map(|rest| tree[..open].to_owned() + &rest).collect()
}

/// What a path written in a module stands for, as names from the crate's root.
fn absolute(path: &str, module: &Module) -> Option<Module> {
    let mut names = path.split("::").map(|name| name.trim().to_owned()).collect::<Vec<_>>();
    let mut base = match names[0].as_str() {
        "crate" => Vec::new(),
        "self" | "super" => module.clone(),
        _ => return None,
    };
    while names.first().is_some_and(|name| matches!(name.as_str(), "crate" | "self" | "super")) {
        if names.remove(0) == "super" {
            base.pop();
        }
    }
    base.extend(names);
    Some(base)
}

/// For each file the files it uses, re-exports followed to where they lead.
fn uses(folder: &Path) -> BTreeMap<Module, BTreeSet<Module>> {
    let modules = modules(folder);
    let mut exports: BTreeMap<Module, Module> = BTreeMap::new();
    let mut paths: BTreeMap<&Module, BTreeSet<Module>> = BTreeMap::new();
    for (module, code) in &modules {
        let own = paths.entry(module).or_default();
        let mut rest = String::new();
        for statement in code.split(';') {
            let Some(at) = statement
                .rfind("use ")
                .filter(|&at| statement[..at].chars().next_back().is_none_or(char::is_whitespace))
            else {
                rest += statement;
                continue;
            };
            rest += &statement[..at];
            let public =
                statement[..at].trim_end().ends_with("pub") || statement[..at].trim_end().ends_with(')');
            for path in named(&statement[at + 4..]) {
                let first = path.split("::").next().unwrap_or_default();
                let child = [module.as_slice(), &[first.to_owned()]].concat();
                let path = if modules.contains_key(&child) { format!("self::{path}") } else { path };
                let Some(target) = absolute(&path, module) else { continue };
                if public && let Some(name) = target.last() {
                    exports.insert([module.as_slice(), std::slice::from_ref(name)].concat(), target.clone());
                }
                if !public || !target.starts_with(module) {
                    own.insert(target);
                }
            }
        }
        for start in ["crate::", "super::"] {
            for (at, _) in rest.match_indices(start) {
                let path: String = rest[at..]
                    .chars()
                    .take_while(|&c| c.is_alphanumeric() || matches!(c, '_' | ':'))
                    .collect();
                let inside = rest[..at].ends_with("in ") || rest[..at].ends_with("::");
                own.extend(absolute(path.trim_end_matches(':'), module).filter(|_| !inside));
            }
        }
    }
    let owner = |mut path: Module| {
        for _ in 0..8 {
            let known = (0..=path.len()).rev().find(|&n| modules.contains_key(&path[..n])).unwrap_or(0);
            let Some(next) = path.get(..known + 1).and_then(|item| exports.get(item)) else {
                return path[..known].to_vec();
            };
            path = [next, &path[known + 1..]].concat();
        }
        path
    };
    let of = |(module, paths): (&Module, BTreeSet<Module>)| {
        let used = paths.into_iter().map(owner).filter(|used| used != module);
        (module.clone(), used.collect())
    };
    paths.into_iter().map(of).collect()
}

#[test]
fn modules_use_only_those_before_them() {
    let rank = |module: &str| ORDER.iter().position(|known| *known == module);
    let mut wrong = Vec::new();
    for (module, used) in uses(&root().join("src")) {
        let Some(first) = module.first() else { continue };
        let own = rank(first).unwrap_or_else(|| panic!("give the module {first} its place in ORDER"));
        let later = used.iter().filter_map(|used| used.first()).filter(|used| rank(used) > Some(own));
        wrong.extend(later.map(|used| format!("{} uses {used}", module.join("::"))));
    }
    assert_eq!(wrong, Vec::<String>::new());
}

#[test]
fn files_use_each_other_in_one_direction() {
    for folder in crates() {
        let mut left = uses(&folder);
        // Who uses nothing that is left goes; what stays is in a circle, or uses one.
        while let Some(done) = left.iter().find(|(_, used)| used.is_empty()).map(|(module, _)| module.clone())
        {
            left.remove(&done);
            left.values_mut().for_each(|used| {
                used.remove(&done);
            });
        }
        // Who is used by nothing that is left is in no circle.
        while let Some(free) =
            left.keys().find(|module| !left.values().any(|used| used.contains(*module))).cloned()
        {
            left.remove(&free);
        }
        assert!(left.is_empty(), "{}: circles among {left:#?}", folder.display());
    }
}

#[test]
fn no_other_program_is_ever_started() {
    for folder in crates() {
        for (module, code) in modules(&folder) {
            let starts = code.contains("process::Command") || code.contains("Command::new(");
            assert!(!starts, "{}", module.join("::"));
        }
    }
}

/// Those of the platform differ in the last bit from one to the next, and with them the G-code.
#[test]
fn functions_of_real_numbers_are_those_of_every_machine() {
    const PLATFORM: [&str; 23] = [
        "sin", "cos", "tan", "sin_cos", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "powf",
        "exp", "exp2", "exp_m1", "ln", "ln_1p", "log", "log2", "log10", "cbrt", "hypot", "mul_add",
    ];
    for folder in crates() {
        for (module, code) in modules(&folder) {
            if module
                .first()
                .is_some_and(|first| matches!(first.as_str(), "cli" | "serve" | "send" | "system"))
            {
                continue;
            }
            let found = PLATFORM.iter().find(|name| code.contains(&format!(".{name}(")));
            assert!(
                found.is_none(),
                "{}: .{}() is the platform's; see geometry::real",
                module.join("::"),
                found.unwrap()
            );
        }
    }
}
