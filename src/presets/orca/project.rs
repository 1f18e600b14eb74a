//! The configuration that these slicers save in a project.

use std::sync::Arc;

use super::convert;
use super::json::File;
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
