//! Presets that are asked for: from where, and what they come to.

use std::path::PathBuf;

use super::args::PresetArgs;
use super::console;
use super::exit::{Exit, Failure};
use super::places;
use crate::presets::{Chosen, Kind, Library, PresetError};
use crate::profile::{Import, Origin, Problem};

/// How many places a message lists.
const PLACES: usize = 12;

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
    if let Some(gone) = named.iter().find(|path| !path.exists()) {
        return Err(Failure::new(Exit::Settings, format!("--presets {}: is not there", gone.display())));
    }
    let places = places::of_this_machine(named);
    let library = Library::open(&places::existing(&places));
    console::warn(library.problems());
    if !library.listed(Kind::Printer).is_empty() {
        return Ok(library);
    }
    let shown = places.iter().take(PLACES).map(|place| format!("\n  {}", place.path.display()));
    let more = places.len().saturating_sub(PLACES);
    let more = if more > 0 { format!("\n  and {more} more folders of slicers") } else { String::new() };
    Err(Failure::new(
        Exit::Settings,
        format!(
            "no printer presets of other slicers were found; name a file or folder of them with --presets or {}. \
             Looked in{}{more}",
            places::VARIABLE,
            shown.collect::<String>()
        ),
    ))
}

/// The presets that are chosen, if any are.
pub(super) fn chosen(args: &PresetArgs) -> Result<Option<Chosen>, Failure> {
    let Some(printer) = &args.printer else { return Ok(None) };
    let library = library(&args.presets)?;
    Ok(Some(library.choose(printer, args.print.as_deref(), args.filament.as_deref())?))
}

/// What is to be known of a choice of presets.
pub(super) fn notes(chosen: &Chosen) -> Vec<Problem> {
    let command = format!(
        "pathwright printers show \"{}\" --print \"{}\" --filament \"{}\"",
        chosen.printer.name, chosen.print.name, chosen.filament.name
    );
    let summary = Import::of(&chosen.config).summary(&command);
    let note = |message| Problem { origin: Origin::Option("--printer"), setting: None, message };
    chosen.notes.iter().cloned().chain(summary).map(note).collect()
}
