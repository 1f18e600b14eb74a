//! The presets of this machine.

use std::path::{Path, PathBuf};

use super::places;
use crate::presets::{Chosen, Config, Kind, Library, Listed, Place, PresetError};
#[cfg(feature = "send")]
use crate::presets::{PhysicalPrinter, is_foreign};

/// How many places a message lists.
const PLACES: usize = 12;

/// Why there are no presets.
#[derive(Debug, thiserror::Error)]
#[error("{message}")]
pub struct NoPresets {
    /// What to do.
    pub message: String,
    /// What was found wrong with the places that were looked at.
    pub problems: Vec<PresetError>,
}

/// The presets of this machine, and before them those of files and folders that are named.
///
/// # Errors
/// One that is named is not there, or cannot be read; there are none at all.
pub fn library(named: &[PathBuf]) -> Result<Library, NoPresets> {
    if let Some(gone) = named.iter().find(|path| !path.exists()) {
        let message = format!("--presets {}: is not there", gone.display());
        return Err(NoPresets { message, problems: Vec::new() });
    }
    let library = all_presets(named);
    if !library.listed(Kind::Printer).is_empty() {
        return Ok(library);
    }
    let places = places::of_this_machine(named);
    let shown = places.iter().take(PLACES).map(|place| format!("\n  {}", place.path.display()));
    let more = places.len().saturating_sub(PLACES);
    let more = if more > 0 { format!("\n  and {more} more folders of slicers") } else { String::new() };
    let message = format!(
        "no printer presets of other slicers were found; name a file or folder of them with --presets or {}. \
         Looked in{}{more}",
        places::VARIABLE,
        shown.collect::<String>()
    );
    Err(NoPresets { message, problems: library.problems().to_vec() })
}

/// As [`library`], be it empty.
pub fn all_presets(named: &[PathBuf]) -> Library {
    Library::open(&places::existing(&places::of_this_machine(named)))
}

/// A physical printer of PrusaSlicer or SuperSlicer: its file, or its name beside the presets of this machine.
///
/// # Errors
/// There is none, or it cannot be read.
#[cfg(feature = "send")]
pub fn physical_printer(name: &str, named: &[PathBuf]) -> Result<PhysicalPrinter, PresetError> {
    let file = Path::new(name);
    if is_foreign(file) && file.is_file() {
        return PhysicalPrinter::read(file);
    }
    PhysicalPrinter::find(&places::existing(&places::of_this_machine(named)), name)
}

/// The presets that a file holds together: a project of another slicer, an exported configuration, G-code.
///
/// # Errors
/// It cannot be read, or holds none.
pub fn saved(file: &str) -> Result<Chosen, String> {
    let config = Config::read(Path::new(file)).map_err(|message| format!("--printer {file}: {message}"))?;
    let listed = |name: &str| Listed {
        name: name.to_owned(),
        dialect: config.dialect,
        is_user: true,
        place: Place::new(file, 0, ""),
    };
    let (printer, print, filament) = (listed(file), listed(""), listed(""));
    Ok(Chosen {
        printer,
        print,
        filament,
        prints: Vec::new(),
        filaments: Vec::new(),
        config,
        notes: Vec::new(),
    })
}
