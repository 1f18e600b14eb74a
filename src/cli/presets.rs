//! Presets that are asked for: from where, and what they come to.

use std::path::{Path, PathBuf};

use super::args::PresetArgs;
use super::console;
use super::exit::{Exit, Failure};
use crate::presets::{Chosen, Library, PresetError, is_foreign};
use crate::system;

impl From<PresetError> for Failure {
    fn from(error: PresetError) -> Self {
        Self::new(Exit::Settings, error)
    }
}

/// The presets of this machine, and before them those of files and folders that are named.
///
/// # Errors
/// One that is named is not there, or cannot be read; there are none at all.
pub(super) fn library(named: &[PathBuf]) -> Result<Library, Failure> {
    let library = system::library(named);
    console::warn(library.as_ref().map_or_else(|none| none.problems.as_slice(), Library::problems));
    library.map_err(|none| Failure::new(Exit::Settings, none))
}

/// The presets that are chosen, if any are.
pub(super) fn chosen(args: &PresetArgs) -> Result<Option<Chosen>, Failure> {
    let Some(printer) = &args.printer else { return Ok(None) };
    if is_foreign(Path::new(printer)) && Path::new(printer).is_file() {
        if let Some(other) = args.print.as_ref().or(args.filament.as_ref()) {
            let message = format!(
                "--printer {printer}: holds all settings together, so that `{other}` has no place; leave it out"
            );
            return Err(Failure::new(Exit::Usage, message));
        }
        return system::saved(printer).map(Some).map_err(|message| Failure::new(Exit::Settings, message));
    }
    let library = library(&args.presets)?;
    Ok(Some(library.choose(printer, args.print.as_deref(), args.filament.as_deref())?))
}
