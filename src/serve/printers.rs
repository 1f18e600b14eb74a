//! The printers of other slicers' presets, as they are listed.

use std::collections::BTreeSet;
use std::sync::OnceLock;

use serde::Serialize;
use utoipa::ToSchema;

use crate::presets::{self, Library, PrinterFacts};

/// A printer of the presets.
#[derive(Clone, Debug, Serialize, ToSchema)]
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
    pub fn of(library: &Library, printer: &presets::Listed) -> Self {
        let config = library.preset(presets::Kind::Printer, &printer.name);
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
    pub fn has(&self, words: &[String]) -> bool {
        let text = format!("{} {} {}", self.name, self.from, self.slicer).to_lowercase();
        words.iter().all(|word| text.contains(word))
    }
}

/// The printers of the presets, listed when they are asked for first.
#[derive(Debug, Default)]
pub struct Printers(OnceLock<Vec<Printer>>);

impl Printers {
    /// Those of a library; every call names the same one.
    pub fn of(&self, library: &Library) -> &[Printer] {
        self.0.get_or_init(|| {
            let mut seen = BTreeSet::new();
            let mut listed = library.listed(presets::Kind::Printer);
            listed.retain(|printer| seen.insert(printer.name.clone()));
            listed.sort_by_key(|printer| printer.name.to_lowercase());
            listed.into_iter().map(|printer| Printer::of(library, printer)).collect()
        })
    }
}
