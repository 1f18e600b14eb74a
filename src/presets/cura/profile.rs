//! Profiles that Cura has exported (`.curaprofile`): a ZIP of changes of a quality, one for the machine and one for each extruder.

use std::io::{Cursor, Read};
use std::path::Path;
use std::sync::Arc;

use zip::ZipArchive;

use super::instance::Instance;
use crate::limits;
use crate::presets::config::Place;
use crate::presets::error::PresetError;
use crate::presets::files::Files;

/// How their names end, in small letters.
pub(super) const ENDING: &str = ".curaprofile";

/// Reads changes: those in an exported profile, or a file of one.
///
/// # Errors
/// It cannot be read, or is damaged.
pub(super) fn read(files: &Files, path: &Path) -> Result<Vec<Instance>, PresetError> {
    let file: Arc<str> = path.display().to_string().into();
    let wrong = |message: String| PresetError::at(Place::new(file.clone(), 0, ""), message);
    let bytes = files.small(path).map_err(wrong)?;
    // Cura before 2.1 wrote text, and single files of changes are such.
    if !bytes.starts_with(b"PK") {
        return Ok(vec![Instance::parse(file.clone(), &String::from_utf8_lossy(&bytes))?]);
    }
    let damaged = |error: String| wrong(format!("is damaged ({error}); export it again"));
    let mut package = ZipArchive::new(Cursor::new(bytes)).map_err(|error| damaged(error.to_string()))?;
    let mut read = Vec::new();
    for index in 0..package.len() {
        let content = package.by_index(index).map_err(|error| damaged(error.to_string()))?;
        let name = format!("{file} {}", content.name().unwrap_or_default());
        let mut text = String::new();
        content
            .take(limits::PRESETS_BYTES)
            .read_to_string(&mut text)
            .map_err(|error| damaged(error.to_string()))?;
        read.push(Instance::parse(name.into(), &text)?);
    }
    Ok(read)
}
