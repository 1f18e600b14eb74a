//! The cross-section of a bead, and what follows from it: spacing, width, flow.
//!
//! A bead of width w and height h is a rectangle with semicircular sides, A = h·(w − h·(1 − π/4)); beads
//! laid A/h apart fill the layer exactly. This is the flow model of Slic3r, used by its descendants.

use std::f64::consts::FRAC_PI_4;

/// Distance between the centre lines of neighbouring beads of a width that fill a layer without void.
pub fn spacing_mm(width_mm: f64, height_mm: f64) -> f64 {
    width_mm - rounding_mm(height_mm)
}

/// Width of the bead that fills a strip.
pub fn width_mm(spacing_mm: f64, height_mm: f64) -> f64 {
    spacing_mm + rounding_mm(height_mm)
}

/// By how much a bead is wider than its spacing: what its round sides leave out.
pub fn rounding_mm(height_mm: f64) -> f64 {
    height_mm * (1.0 - FRAC_PI_4)
}

/// Cross-section in square millimetres; never negative.
pub fn area_mm2(width_mm: f64, height_mm: f64) -> f64 {
    (spacing_mm(width_mm, height_mm) * height_mm).max(0.0)
}
