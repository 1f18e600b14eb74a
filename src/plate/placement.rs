//! How models are placed.

/// The method of arrangement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrange {
    /// Files, each with the layout that it has; where one does not fit, its bodies.
    Layouts,
    /// Bodies, each by itself.
    Bodies,
    /// The files' own coordinates, as those of the bed.
    Off,
}

/// How models are placed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Width to keep free along the bed's edge, for skirt and brim.
    pub margin_mm: f64,
    /// Least distance between models, and what is printed around them.
    pub spacing_mm: f64,
    /// How far brim, raft and supports reach around each model.
    pub reach_mm: f64,
    /// Whether models keep the distance from each other's convex hull, instead of only from the outline.
    pub convex: bool,
    /// Whether models may be turned by quarters about Z to fit.
    pub turn: bool,
    /// What is arranged.
    pub arrange: Arrange,
    /// Moves everything away from the middle of the bed; a negative Z sinks it, which cuts off the bottom.
    pub shift_mm: [f64; 3],
}

impl Default for Placement {
    fn default() -> Self {
        Self {
            margin_mm: 0.0,
            spacing_mm: 5.0,
            reach_mm: 0.0,
            convex: false,
            turn: false,
            arrange: Arrange::Layouts,
            shift_mm: [0.0; 3],
        }
    }
}

impl Placement {
    /// Least distance between bodies that are printed one after the other, with what is printed around them.
    pub(super) fn apart_mm(&self) -> f64 {
        self.spacing_mm + 2.0 * self.reach_mm
    }
}
