//! Where the nozzle may be: inside the printable volume.

use geometry::real;

use super::fault::Kind;
use super::report::Found;
use super::rule::{LineContext, Rule};
use crate::plate::BedShape;
use crate::profile::Settings;

/// Coordinates are rounded to this.
const SLACK_MM: f64 = 2e-3;
/// Number of points at which an arc is tested.
const ARC_PLACES: usize = 16;

/// The printable volume.
pub(super) struct Bed {
    low: [f64; 2],
    high: [f64; 2],
    round: bool,
    /// Rectangles in which nothing may be printed, by their corners.
    excluded: Vec<[[f64; 2]; 2]>,
    /// The printer's Z of the bed's surface.
    floor_mm: f64,
    top_mm: f64,
}

impl Bed {
    pub fn new(settings: &Settings) -> Self {
        let floor_mm = settings.layer.z_offset.0;
        Self {
            low: settings.bed.low_mm(),
            high: settings.bed.high_mm(),
            round: settings.bed.shape == BedShape::Round,
            excluded: settings.bed.excluded_mm().collect(),
            floor_mm,
            top_mm: settings.bed.height.0 + floor_mm.max(0.0) + settings.layer.height.0 / 2.0,
        }
    }

    fn holds(&self, [x, y, z]: [f64; 3]) -> bool {
        let inside = if self.round {
            let middle = [0, 1].map(|i| (self.low[i] + self.high[i]) / 2.0);
            real::hypot(x - middle[0], y - middle[1]) <= (self.high[0] - self.low[0]) / 2.0 + SLACK_MM
        } else {
            let within = |v: f64, i: usize| self.low[i] - SLACK_MM <= v && v <= self.high[i] + SLACK_MM;
            within(x, 0) && within(y, 1)
        };
        inside && z <= self.top_mm + SLACK_MM
    }
}

impl Rule for Bed {
    fn check_line(&mut self, seen: &LineContext<'_>, found: &mut Found) {
        let Some(stroke) = seen.stroke() else { return };
        let [x, y, z] = stroke.to;
        let arc = stroke.arc.is_some() && stroke.xy_mm.is_finite();
        let between = |i: usize| stroke.at(i as f64 / ARC_PLACES as f64);
        if !self.holds(stroke.to) || arc && (1..ARC_PLACES).any(|i| !self.holds(between(i))) {
            let kind = match (seen.begun, seen.in_script) {
                (false, _) => Kind::OutsideAtStart,
                (true, true) => Kind::OutsideInScript,
                (true, false) => Kind::OutsideBed,
            };
            seen.fault(found, kind, || format!("to X{x:.3} Y{y:.3} Z{z:.3}"));
        }
        let is_excluded = |[low, high]: &[[f64; 2]; 2]| {
            let inside = |at: f64, i: usize| low[i] + SLACK_MM < at && at < high[i] - SLACK_MM;
            inside(x, 0) && inside(y, 1)
        };
        let is_bead = stroke.extrudes() && seen.begun && !seen.in_script;
        if is_bead && self.excluded.iter().any(is_excluded) {
            seen.fault(found, Kind::OutsideBed, || {
                format!("a bead to X{x:.3} Y{y:.3}, where nothing may be printed")
            });
        }
        // A bead needs some height; elsewhere the nozzle may touch the bed.
        let lowest_mm = if stroke.extrudes() { self.floor_mm + 1e-6 } else { self.floor_mm - SLACK_MM };
        if z < lowest_mm && (seen.begun || stroke.extrudes()) {
            seen.fault(found, Kind::BelowBed, || format!("Z{z:.3}"));
        }
    }
}
