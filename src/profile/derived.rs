//! What follows from settings.

use std::f64::consts::PI;

use super::settings::{BedOrigin, BedSettings, FilamentSettings, TravelSettings};
use crate::units::Mm;

impl BedSettings {
    /// The corner of least X and Y, millimetres.
    pub fn low_mm(&self) -> [f64; 2] {
        match self.origin {
            BedOrigin::Corner => [0.0; 2],
            BedOrigin::Center => self.size.map(|length| -length.0 / 2.0),
        }
    }

    /// The corner of greatest X and Y, millimetres.
    pub fn high_mm(&self) -> [f64; 2] {
        let low = self.low_mm();
        [0, 1].map(|i| low[i] + self.size[i].0)
    }

    /// The middle, millimetres.
    pub fn middle_mm(&self) -> [f64; 2] {
        match self.origin {
            BedOrigin::Corner => self.size.map(|length| length.0 / 2.0),
            BedOrigin::Center => [0.0; 2],
        }
    }
}

impl FilamentSettings {
    /// Cross-section of the strand, square millimetres.
    pub fn area_mm2(&self) -> f64 {
        strand_area_mm2(self.diameter)
    }
}

impl TravelSettings {
    /// By how much a detour may lengthen a travel, millimetres; 0: travels go straight.
    pub fn detour_mm(&self) -> f64 {
        if self.avoid_crossing { self.max_detour.0 } else { 0.0 }
    }
}

/// Cross-section of a strand of a diameter, square millimetres.
pub fn strand_area_mm2(diameter: Mm) -> f64 {
    PI / 4.0 * diameter.0 * diameter.0
}
