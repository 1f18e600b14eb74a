//! What can be set.

use pathwright::Settings;
use pathwright::job::ObjectSettings;
use pathwright::profile::{Kind, keys};
use pyo3::prelude::*;
use serde_json::{Map, Value, json};

/// Every key with its meaning, kind, unit, range, choices and default, as JSON.
#[pyfunction]
pub fn schema() -> String {
    let defaults = serde_json::to_value(Settings::default()).unwrap_or_default();
    let keys = keys().map(|(key, field)| {
        let (section, name) = key.split_once('.').unwrap_or_default();
        let (kind, choices, count) = match field.kind {
            Kind::Number => ("number", None, None),
            Kind::Count => ("integer", None, None),
            Kind::Share => ("percent", None, None),
            Kind::Flag => ("boolean", None, None),
            Kind::Text => ("text", None, None),
            Kind::Choice(words) => ("choice", Some(words), None),
            Kind::Numbers(count) => ("list", None, Some(count)),
            Kind::List => ("list", None, None),
        };
        let about = json!({
            "help": field.doc.trim(),
            "kind": kind,
            "unit": field.unit,
            "min": field.range.map(|range| range.0),
            "max": field.range.map(|range| range.1),
            "choices": choices,
            "count": count,
            "default": defaults[section][name],
            "per_object": ObjectSettings::SECTIONS.contains(&section),
        });
        (key, about)
    });
    Value::Object(keys.collect::<Map<_, _>>()).to_string()
}
