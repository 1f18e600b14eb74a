//! Settings in force as TOML or JSON with their origin, and the reference of all keys as Markdown.

use std::fmt::Write;

use serde_json::json;
use toml::{Table, Value};

use super::resolve::Resolved;
use super::script::{PLACEHOLDERS, PRINT_NAMES, setting_names};
use super::settings::{SECTIONS, Settings};
use super::value::toml_text;
use crate::options::{Field, Kind};

/// Every setting in force as a profile that means the same, each with a comment that says where it came from.
pub fn dump_toml(resolved: &Resolved) -> String {
    let values = table(&resolved.settings);
    let mut out = String::new();
    for section in SECTIONS {
        let _ = writeln!(out, "{}[{}]", if out.is_empty() { "" } else { "\n" }, section.name);
        for field in section.fields {
            let value = toml_text(&values[section.name][field.name]);
            let origin = &resolved.origins[&format!("{}.{}", section.name, field.name)];
            let _ = match value.contains('\n') {
                true => writeln!(out, "# {origin}\n{} = {value}", field.name),
                false => writeln!(out, "{} = {value} # {origin}", field.name),
            };
        }
    }
    for (number, tool) in (1..).zip(&resolved.settings.tools) {
        out.push_str("\n[[tools]]\n");
        for (key, value) in tool.own() {
            let origin = resolved.origins.get(&format!("tools.{number}.{key}"));
            let origin = origin.map(|origin| format!("# {origin}\n")).unwrap_or_default();
            let _ = writeln!(out, "{origin}{key} = {}", toml_text(value));
        }
    }
    if !resolved.settings.variables.is_empty() {
        out.push_str("\n[variables]\n");
        for (name, value) in &resolved.settings.variables {
            let origin = resolved.origins.get(&format!("variables.{name}"));
            let origin = origin.map(|origin| format!("# {origin}\n")).unwrap_or_default();
            let _ = writeln!(out, "{origin}{name} = {}", toml_text(value));
        }
    }
    out
}

/// The same as a JSON object: dotted key → `{ "value": …, "origin": … }`.
pub fn dump_json(resolved: &Resolved) -> serde_json::Value {
    let values = table(&resolved.settings);
    let mut out = serde_json::Map::new();
    for section in SECTIONS {
        for field in section.fields {
            let key = format!("{}.{}", section.name, field.name);
            let origin = resolved.origins[&key].to_string();
            let value = json!({ "value": values[section.name][field.name], "origin": origin });
            out.insert(key, value);
        }
    }
    for (number, tool) in (1..).zip(&resolved.settings.tools) {
        for (key, value) in tool.own() {
            let key = format!("tools.{number}.{key}");
            let origin = resolved.origins.get(&key).map(ToString::to_string);
            out.insert(key, json!({ "value": value, "origin": origin }));
        }
    }
    serde_json::Value::Object(out)
}

/// The reference of every key and placeholder: `docs/settings.md`.
pub fn reference() -> String {
    let defaults = table(&Settings::default());
    let mut out = String::from(REFERENCE_HEAD);
    for section in SECTIONS {
        let heading =
            section.doc.trim().trim_start_matches(&format!("`[{}]`", section.name)).trim_start_matches(':');
        let _ = writeln!(out, "\n## `[{}]`\n", section.name);
        if !heading.trim().is_empty() {
            let _ = writeln!(out, "{}\n", capitalised(heading.trim()));
        }
        out.push_str("| key | default | takes | meaning |\n|---|---|---|---|\n");
        for field in section.fields {
            let default = default_text(&defaults[section.name][field.name]);
            let (name, doc) = (field.name, field.doc.trim());
            let _ = writeln!(out, "| `{}.{name}` | {default} | {} | {doc} |", section.name, takes(field));
        }
    }
    out.push_str(PLACEHOLDER_HEAD);
    for (name, meaning) in PLACEHOLDERS.iter().chain(PRINT_NAMES) {
        let _ = writeln!(out, "| `{name}` | {meaning} |");
    }
    for (name, key) in setting_names() {
        let _ = writeln!(out, "| `{name}` | `{key}` |");
    }
    out
}

const REFERENCE_HEAD: &str = "# Settings\n\n\
    Every key of a profile; `--set KEY=VALUE` takes the same. The defaults are those of the embedded profile\n\
    `default`. This page is printed by `pathwright profiles reference`, and a test keeps it true.\n";

const PLACEHOLDER_HEAD: &str = "\n## Placeholders in scripts\n\n\
    Scripts (`gcode.start` and the others) are written in the macro language of PrusaSlicer: `{name}` or `[name]`,\n\
    `{expression}`, `{if}` … `{elsif}` … `{else}` … `{endif}`, variables and functions; see\n\
    [crates/macros](../crates/macros/README.md). `{{` and a `}}` after it on the line stand for the braces themselves.\n\
    Besides these names there are those of the profile's `[variables]`, and PrusaSlicer's settings, with what it takes by\n\
    default where no profile says them. A name that is not known is an error.\n\
    Numbers are in millimetres, in the bed's own coordinates.\n\n\
    | name | meaning |\n|---|---|\n";

fn table(settings: &Settings) -> Table {
    Table::try_from(settings).expect("settings are a table")
}

fn default_text(value: &Value) -> String {
    match value {
        Value::String(text) if text.contains('\n') => {
            "a script: `pathwright profiles show reprap-250`".into()
        }
        value => format!("`{value}`"),
    }
}

fn takes(field: &Field) -> String {
    let text = field.expected();
    match field.kind {
        Kind::Choice(names) => names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", "),
        _ => text.trim_start_matches("a ").to_owned(),
    }
}

fn capitalised(text: &str) -> String {
    let mut chars = text.chars();
    chars.next().map(|first| first.to_uppercase().chain(chars).collect()).unwrap_or_default()
}
