//! `[[tools]]`: the settings that each tool has of its own.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use toml::{Table, Value};

/// Most tools that a printer has.
pub const MOST_TOOLS: usize = 16;

/// What the keys of tools begin with: `tools.2.filament.color`.
pub(super) const TOOLS: &str = "tools.";

/// Sections of which a tool may have values of its own, and single keys of others.
const SECTIONS: [&str; 4] = ["tool.", "filament.", "retract.", "swap."];
const KEYS: [&str; 16] = [
    "printer.nozzle_diameter",
    "temperature.nozzle",
    "temperature.nozzle_first_layer",
    "cooling.fan",
    "cooling.bridge_fan",
    "tool_change.script",
    "tool_change.time",
    "gcode.filament_start",
    "gcode.filament_end",
    "walls.width",
    "walls.external_width",
    "shell.width",
    "shell.top_width",
    "infill.width",
    "support.width",
    "first_layer.width",
];

/// The settings that a tool has of its own, by section and name.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Tool(BTreeMap<String, BTreeMap<String, Value>>);

/// Whether a tool may have a value of its own for a key.
pub(super) fn may_differ(key: &str) -> bool {
    SECTIONS.iter().any(|section| key.starts_with(section)) || KEYS.contains(&key)
}

/// What a tool may have, in words.
pub(super) fn may_have() -> String {
    let sections = SECTIONS.iter().map(|section| format!("{section}*"));
    sections.chain(KEYS.iter().map(|key| (*key).to_owned())).collect::<Vec<_>>().join(", ")
}

/// A tool, counted from 0, and the dotted key of a setting of its own, out of `tools.2.filament.color`; the tool's own keys
/// need no section.
///
/// # Errors
/// What would be right.
pub(super) fn split(key: &str) -> Result<(usize, String), String> {
    let wrong = || {
        format!("`tools.N.KEY` is expected, with N from 1 to {MOST_TOOLS}, such as `tools.2.filament.color`")
    };
    let (number, key) = key.strip_prefix(TOOLS).and_then(|rest| rest.split_once('.')).ok_or_else(wrong)?;
    let number: usize = number.parse().map_err(|_| wrong())?;
    if !(1..=MOST_TOOLS).contains(&number) {
        return Err(wrong());
    }
    let key = if key.contains('.') { key.to_owned() } else { format!("tool.{key}") };
    Ok((number - 1, key))
}

/// A tool, counted from 0, out of `tools.2`, which says that there is one.
pub(super) fn number(key: &str) -> Option<usize> {
    let number: usize = key.strip_prefix(TOOLS)?.parse().ok()?;
    (1..=MOST_TOOLS).contains(&number).then(|| number - 1)
}

/// The entries of `[[tools]]` as keys and values; what is no table keeps the key of its tool.
pub(super) fn flattened(value: Value) -> Vec<(String, Value)> {
    let Value::Array(tools) = value else { return vec![("tools".into(), value)] };
    let mut all = Vec::new();
    for (number, tool) in (1..).zip(tools) {
        let Value::Table(keys) = tool else {
            all.push((format!("tools.{number}"), tool));
            continue;
        };
        // The tool is there, even where it says nothing of itself.
        all.push((format!("tools.{number}"), Value::Table(Table::new())));
        // What the tool says itself wins over its profile.
        let (profile, own): (Vec<_>, Vec<_>) = keys.into_iter().partition(|(key, _)| key == "profile");
        for (key, value) in profile.into_iter().chain(own) {
            match value {
                Value::Table(section) => all.extend(
                    section.into_iter().map(|(name, value)| (format!("tools.{number}.{key}.{name}"), value)),
                ),
                value => all.push((format!("tools.{number}.{key}"), value)),
            }
        }
    }
    all
}

impl Tool {
    /// Every dotted key with its value.
    pub fn own(&self) -> impl Iterator<Item = (String, &Value)> {
        self.0.iter().flat_map(|(section, keys)| {
            keys.iter().map(move |(name, value)| (format!("{section}.{name}"), value))
        })
    }
}
