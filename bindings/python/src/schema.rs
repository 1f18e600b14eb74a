//! What can be set.

use pathwright::job::catalog::Schema;
use pyo3::prelude::*;
use serde_json::{Map, Value, json};

/// Every key with its meaning, kind, unit, range, choices and default, as JSON.
#[pyfunction]
pub fn schema() -> String {
    let settings = Schema::known().groups.iter().flat_map(|group| &group.settings);
    let keys = settings.map(|setting| {
        let mut about = json!(setting);
        if let Some(about) = about.as_object_mut() {
            about.remove("key");
            // What does not apply is there, too.
            for name in ["min", "max", "choices", "count"] {
                about.entry(name).or_insert(Value::Null);
            }
            about.entry("unit").or_insert_with(|| "".into());
        }
        (setting.key.clone(), about)
    });
    Value::Object(keys.collect::<Map<_, _>>()).to_string()
}
