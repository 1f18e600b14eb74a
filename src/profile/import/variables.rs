//! What scripts of others may name: every value of their configuration, under the names that they have for it.

use macros::Value as Known;
use toml::Value;

use crate::presets::{Config, script_value};

/// Names and values, in the order of the names.
pub(super) fn all(config: &Config) -> Vec<(String, Value)> {
    let is_name = |name: &str| name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    let named = config.raw.iter().filter(|(name, _)| is_name(name));
    named.map(|(name, raw)| (name.clone(), to_toml(script_value(raw)))).collect()
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
