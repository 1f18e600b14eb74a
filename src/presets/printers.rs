//! Printers of presets, as they are listed, and what goes with each.

use std::collections::BTreeSet;
use std::sync::OnceLock;

use serde::Serialize;

use super::error::PresetError;
use super::family::{Kind, Listed};
use super::library::Library;
use super::printer::PrinterFacts;

/// A printer of the presets.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "serve", derive(utoipa::ToSchema))]
pub struct Printer {
    /// By which it is chosen.
    name: String,
    /// Whose presets they are.
    slicer: &'static str,
    /// Made by a user, not by a vendor.
    user: bool,
    /// Width and depth of the bed.
    #[serde(skip_serializing_if = "Option::is_none")]
    bed_mm: Option<[f64; 2]>,
    /// Height of the printer.
    #[serde(skip_serializing_if = "Option::is_none")]
    height_mm: Option<f64>,
    /// Diameter of the nozzle.
    #[serde(skip_serializing_if = "Option::is_none")]
    nozzle_mm: Option<f64>,
    /// As the slicer calls it.
    firmware: String,
    /// Name of the file that it is from.
    from: String,
    /// Why it cannot be used, if so.
    #[serde(skip_serializing_if = "Option::is_none")]
    problem: Option<String>,
}

impl Printer {
    /// As it is listed.
    fn of(library: &Library, printer: &Listed) -> Self {
        let config = library.preset(Kind::Printer, &printer.name);
        let facts = config.as_ref().map(PrinterFacts::of).unwrap_or_default();
        Self {
            name: printer.name.clone(),
            slicer: printer.dialect.name(),
            user: printer.is_user,
            bed_mm: facts.bed_mm,
            height_mm: facts.height_mm,
            nozzle_mm: facts.nozzle_mm,
            firmware: facts.firmware,
            // Folders of this machine are nobody's business.
            from: printer.place.file.rsplit(['/', '\\']).next().unwrap_or_default().to_owned(),
            problem: config.err().map(|error| error.to_string()),
        }
    }

    /// Whether its name, file and slicer have all these words, which are in small letters.
    fn has(&self, words: &[String]) -> bool {
        let text = format!("{} {} {}", self.name, self.from, self.slicer).to_lowercase();
        words.iter().all(|word| text.contains(word))
    }
}

/// The printers of the presets, listed when they are asked for first.
#[derive(Debug, Default)]
pub struct Printers(OnceLock<Vec<Printer>>);

impl Printers {
    /// Those of a library whose name, file and slicer have all words, at most so many. Every call names the same library.
    pub fn find(&self, library: &Library, words: &str, most: usize) -> Vec<&Printer> {
        let words: Vec<String> = words.split_whitespace().map(str::to_lowercase).collect();
        self.of(library).iter().filter(|printer| printer.has(&words)).take(most).collect()
    }

    fn of(&self, library: &Library) -> &[Printer] {
        self.0.get_or_init(|| {
            let mut seen = BTreeSet::new();
            let mut listed = library.listed(Kind::Printer);
            listed.retain(|printer| seen.insert(printer.name.clone()));
            listed.sort_by_key(|printer| printer.name.to_lowercase());
            listed.into_iter().map(|printer| Printer::of(library, printer)).collect()
        })
    }
}

/// A printer with the presets that fit it.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "serve", derive(utoipa::ToSchema))]
pub struct PrinterPresets {
    /// The printer.
    printer: Printer,
    /// Print presets that fit.
    prints: Vec<String>,
    /// Filament presets that fit it and the print preset.
    filaments: Vec<String>,
    /// The print preset that is taken where none is named.
    default_print: String,
    /// The filament preset that is taken where none is named.
    default_filament: String,
    /// What is to be known of the choice.
    notes: Vec<String>,
}

impl PrinterPresets {
    /// Those of a printer, with a print preset or its own.
    ///
    /// # Errors
    /// Presets that do not resolve.
    pub fn of(library: &Library, printer: &str, print: Option<&str>) -> Result<Self, PresetError> {
        let chosen = library.choose(printer, print, None)?;
        Ok(Self {
            printer: Printer::of(library, &chosen.printer),
            prints: chosen.prints,
            filaments: chosen.filaments,
            default_print: chosen.print.name,
            default_filament: chosen.filament.name,
            notes: chosen.notes,
        })
    }
}
