//! What the writer needs to know.

use super::script::Scripts;
use crate::profile::{Flavor, Settings};
use crate::units::Mm;

/// What is known of a print before its first layer is planned.
#[derive(Clone, Debug, PartialEq)]
pub struct PrintFacts {
    /// Number of layers.
    pub layers: usize,
    /// Smallest X and Y that are printed on, bed coordinates, millimetres.
    pub min_mm: [f64; 2],
    /// Largest X and Y.
    pub max_mm: [f64; 2],
    /// Top of the last layer, Z offset included.
    pub max_z_mm: f64,
    /// Seconds since 1970 that the header is dated with: `SOURCE_DATE_EPOCH`, or a fixed value, so that the same
    /// input gives the same bytes.
    pub dated: u64,
}

/// An object on the plate, as printers that can cancel one are told of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObjectLabel {
    /// Smallest X and Y that it is printed on, bed coordinates, millimetres.
    pub min_mm: [f64; 2],
    /// Largest X and Y.
    pub max_mm: [f64; 2],
}

/// The settings of [`format_layer`](super::format_layer).
#[derive(Clone, Debug, PartialEq)]
pub struct WriterSettings {
    /// Firmware dialect.
    pub flavor: Flavor,
    /// E counts from the last move (M83) instead of from the layer's start (M82).
    pub relative_e: bool,
    /// Diameter of the strand.
    pub filament_diameter: Mm,
    /// Write G10 and G11 instead of E moves.
    pub firmware_retraction: bool,
    /// Lines of a pause, placeholders filled in; empty: the flavour's own.
    pub pause: String,
    /// Leave a blank line of fixed width in every layer, for M73.
    pub progress: bool,
}

impl WriterSettings {
    /// What the writer needs of all settings. `progress` is for outputs that can be patched later.
    pub fn new(settings: &Settings, scripts: &Scripts, progress: bool) -> Self {
        Self {
            flavor: settings.printer.flavor,
            relative_e: settings.gcode.relative_e,
            filament_diameter: settings.filament.diameter,
            firmware_retraction: settings.retract.firmware,
            pause: scripts.pause.clone(),
            progress,
        }
    }
}

/// Cross-section of the strand, square millimetres.
pub(super) fn filament_area_mm2(diameter: Mm) -> f64 {
    std::f64::consts::PI / 4.0 * diameter.0 * diameter.0
}
