//! Presets that are asked for: from where, and what they come to.

use std::path::{Path, PathBuf};

use super::args::PresetArgs;
use super::console;
use super::exit::{Exit, Failure};
use super::places;
use crate::presets::{Chosen, Config, Kind, Library, Listed, Place, PresetError, is_foreign};

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
    if is_foreign(Path::new(printer)) && Path::new(printer).is_file() {
        return saved(args, printer).map(Some);
    }
    let library = library(&args.presets)?;
    Ok(Some(library.choose(printer, args.print.as_deref(), args.filament.as_deref())?))
}

/// The presets that a file holds together: a project, an exported configuration, G-code.
fn saved(args: &PresetArgs, file: &str) -> Result<Chosen, Failure> {
    if let Some(other) = args.print.as_ref().or(args.filament.as_ref()) {
        let message = format!(
            "--printer {file}: holds all settings together, so that `{other}` has no place; leave it out"
        );
        return Err(Failure::new(Exit::Usage, message));
    }
    let config = Config::read(Path::new(file))
        .map_err(|message| Failure::new(Exit::Settings, format!("--printer {file}: {message}")))?;
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
