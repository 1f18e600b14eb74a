//! What scripts of others may name: every value of their configuration, under the names that they have for it.

use std::collections::BTreeMap;

use macros::Value as Known;
use toml::Value;

use crate::presets::{Config, Raw, script_value};

/// What scripts call the names of presets, and the keys in which configurations have them.
const NAMES_OF_PRESETS: [(&str, &str); 4] = [
    ("print_preset", "print_settings_id"),
    ("filament_preset", "filament_settings_id"),
    ("printer_preset", "printer_settings_id"),
    ("physical_printer_preset", "physical_printer_settings_id"),
];

/// Names and values, in the order of the names.
pub(super) fn all(config: &Config) -> Vec<(String, Value)> {
    let is_name = |name: &str| name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    let named = config.raw.iter().map(|(name, raw)| (name.as_str(), raw)).filter(|(name, _)| is_name(name));
    let presets = NAMES_OF_PRESETS.iter().filter_map(|(name, key)| Some((*name, config.raw.get(*key)?)));
    // What the configuration itself says of a name is the last.
    let all: BTreeMap<&str, &Raw> = presets.chain(named).collect();
    all.into_iter().map(|(name, raw)| (name.to_owned(), to_toml(script_value(raw)))).collect()
}

/// A value as profiles write it: percentages and what is not set are texts.
fn to_toml(value: Known) -> Value {
    match value {
        Known::Flag(flag) => Value::Boolean(flag),
        Known::Integer(whole) => Value::Integer(whole),
        Known::Real(real) => Value::Float(real),
        Known::Percent(percent) => Value::String(format!("{percent}%")),
        Known::Text(text) => Value::String(text),
        Known::Nil => Value::String("nil".into()),
        Known::List(values) => Value::Array(values.into_iter().map(to_toml).collect()),
    }
}
