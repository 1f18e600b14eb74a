//! The cross-section of a bead, and what follows from it: spacing, width, flow.
//!
//! A bead of width w and height h is a rectangle with semicircular sides, A = h·(w − h·(1 − π/4)); beads
//! laid A/h apart fill the layer exactly. This is the flow model of Slic3r, used by its descendants.

use std::f64::consts::FRAC_PI_4;

use geometry::Point;

/// The line that a bead follows, without what it is for.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Vertices.
    pub points: Vec<Point>,
    /// Spacing of the bead at each vertex, in millimetres; empty where it is the nominal one throughout.
    pub spacing_mm: Vec<f32>,
    /// Whether it returns to its first vertex.
    pub closed: bool,
}

impl Line {
    /// A line of nominal spacing.
    pub(super) fn nominal(points: Vec<Point>, closed: bool) -> Self {
        Self { points, spacing_mm: Vec::new(), closed }
    }

    /// The line, unless it has lost its vertices.
    pub(super) fn sound(self) -> Option<Self> {
        (self.points.len() >= if self.closed { 3 } else { 2 }).then_some(self)
    }
}

/// Distance between the centre lines of neighbouring beads of a width that fill a layer without void.
pub fn spacing_mm(width_mm: f64, height_mm: f64) -> f64 {
    width_mm - rounding_mm(height_mm)
}

/// Width of the bead that fills a strip.
pub fn width_mm(spacing_mm: f64, height_mm: f64) -> f64 {
    spacing_mm + rounding_mm(height_mm)
}

/// Difference between a bead's width and its spacing, due to its round sides.
pub fn rounding_mm(height_mm: f64) -> f64 {
    height_mm * (1.0 - FRAC_PI_4)
}

/// Cross-section in square millimetres; never negative.
pub fn area_mm2(width_mm: f64, height_mm: f64) -> f64 {
    (spacing_mm(width_mm, height_mm) * height_mm).max(0.0)
}
