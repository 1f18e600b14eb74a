//! What is to be known of presets that were chosen.

use super::error::{Origin, Problem};
use super::import::Import;
use crate::presets::Chosen;

/// Notes on a choice of presets, and a summary of what is not taken over.
pub fn preset_notes(chosen: &Chosen) -> Vec<Problem> {
    let command = match chosen.print.name.as_str() {
        "" => format!("pathwright profiles show {}", chosen.printer.name),
        print => format!(
            "pathwright printers show \"{}\" --print \"{print}\" --filament \"{}\"",
            chosen.printer.name, chosen.filament.name
        ),
    };
    let summary = Import::of(&chosen.config).summary(&command);
    let note = |message| Problem { origin: Origin::Option("--printer"), setting: None, message };
    chosen.notes.iter().cloned().chain(summary).map(note).collect()
}
