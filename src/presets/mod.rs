//! Presets of other slicers, found by name and resolved into one configuration.
//!
//! A [`Library`] is read from files and folders that its caller names; nothing here looks for them.

mod bundle;
mod config;
mod cura;
mod error;
mod family;
mod file;
mod files;
mod ini;
mod keys;
mod library;
mod names;
mod orca;
mod physical;
mod printer;
mod printers;
mod project;
mod prusa;
mod saved;
mod superslicer;
mod value;

pub use config::{Config, Dialect, Entry, Place, Raw};
pub use error::PresetError;
pub use family::{Kind, Listed, Source};
pub use file::{bundle_values, is_foreign};
pub use files::Files;
pub use keys::key_type;
pub use library::{Chosen, Library, is_preset_file};
pub use names::{built_in_value, script_value};
pub use physical::PhysicalPrinter;
pub use printer::PrinterFacts;
pub use printers::{Printer, PrinterPresets, Printers};
pub(crate) use saved::of_saved;
pub use value::{Scalar, Shape, Type};
