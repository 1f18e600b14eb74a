//! The configuration that these slicers save in a project.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::convert;
use super::json::{File, Written};
use super::keys::{self, ABOUT};
use super::values::Values;
use crate::presets::config::{Config, Place};
use crate::presets::error::PresetError;

/// Reads a project's configuration (`Metadata/project_settings.config`, JSON): machine, process and filaments in one.
///
/// # Errors
/// It is no JSON.
pub(in crate::presets) fn project(name: impl Into<Arc<str>>, bytes: &[u8]) -> Result<Config, PresetError> {
    let file = File::parse(name.into(), bytes)?;
    let mut values = Values::new(keys::built_in);
    for (key, written) in file.entries {
        if !ABOUT.contains(&key.as_str()) && key != "inherits" {
            let place = Place::new(file.path.clone(), written.line, "");
            values.set(&key, written, place);
        }
    }
    Ok(convert::config(&values))
}

/// What is saved with an object of a project: some of the process's settings, each one text.
pub(in crate::presets) fn of_object(entries: &BTreeMap<String, String>, place: &Place) -> Config {
    let mut values = Values::new(keys::built_in);
    for (key, value) in entries {
        values.set(key, Written { values: vec![value.clone()], is_list: false, line: 0 }, place.clone());
    }
    convert::config(&values)
}
