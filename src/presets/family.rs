//! What the presets of any slicer can be asked for. There is a family for each way to write presets: bundles of PrusaSlicer
//! and SuperSlicer, JSON of OrcaSlicer and its kin, definitions of Cura.

use std::fmt::Debug;
use std::path::PathBuf;

use super::config::{Config, Dialect, Place};
use super::error::PresetError;

/// What a preset is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Kind {
    /// A machine: bed, limits, scripts, retraction.
    Printer,
    /// Layer heights, widths, speeds, infill.
    Print,
    /// Temperatures, cooling, flow.
    Filament,
}

impl Kind {
    /// As it is called in messages, and in bundles.
    pub fn name(self) -> &'static str {
        match self {
            Self::Printer => "printer",
            Self::Print => "print",
            Self::Filament => "filament",
        }
    }
}

/// A file or folder that may hold presets.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    /// Need not exist.
    pub path: PathBuf,
    /// Whose presets are looked for; `None`: to be seen from what is there.
    pub dialect: Option<Dialect>,
}

/// A preset that can be chosen.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Listed {
    /// By which it is chosen.
    pub name: String,
    /// Whose.
    pub dialect: Dialect,
    /// Made by a user, not by a vendor.
    pub is_user: bool,
    /// Its file, and the line on which it begins.
    pub place: Place,
}

/// Presets of one way of writing them, from all sources that have such.
///
/// Reading a family lists its presets; what they say is read when it is asked for. Names are exact.
pub(super) trait Family: Debug + Send + Sync {
    /// Every preset of a kind that can be chosen; of those of one name the first is taken, users' are before vendors'.
    fn listed(&self, kind: Kind) -> Vec<&Listed>;

    /// Those presets of a kind that have a name, in the order in which they are taken.
    fn named(&self, kind: Kind, name: &str) -> Vec<&Listed>;

    /// The name that a preset has now, given one that it had formerly.
    fn renamed(&self, kind: Kind, formerly: &str) -> Option<&str>;

    /// One preset with all that it inherits; of a printer also what the slicer has built in, so that its bed, nozzle and
    /// firmware are known.
    ///
    /// # Errors
    /// It is not there, or does not resolve.
    fn preset(&self, kind: Kind, name: &str) -> Result<Config, PresetError>;

    /// Names of the print presets that fit a printer (`print`: `None`), or of the filament presets that fit a printer and a
    /// print; each once, in the slicer's order.
    ///
    /// # Errors
    /// One of them does not resolve, or has a condition that cannot be decided.
    fn compatible(&self, kind: Kind, printer: &str, print: Option<&str>) -> Result<Vec<String>, PresetError>;

    /// The names that a printer (and a print) would have its print or filament preset chosen from, the best first.
    ///
    /// # Errors
    /// It does not resolve.
    fn preferred(&self, kind: Kind, printer: &str, print: Option<&str>) -> Result<Vec<String>, PresetError>;

    /// Whether a preset is of the printer's vendor, or of a user.
    fn is_own(&self, _kind: Kind, _printer: &str, _name: &str) -> bool {
        true
    }

    /// How little a preset is what most would take with a printer, where that names none that fits.
    fn unlike(&self, _kind: Kind, _printer: &str, _name: &str) -> u64 {
        0
    }

    /// The three as one configuration, what the slicer has built in at the bottom.
    ///
    /// # Errors
    /// One of them is not there, or does not resolve.
    fn resolve(&self, printer: &str, print: &str, filament: &str) -> Result<Config, PresetError>;
}
