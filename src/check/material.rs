//! What has been printed is in the nozzle's way.

use super::fault::Kind;
use super::relief::Relief;
use super::report::Found;
use super::rule::{Rule, Seen};
use crate::gcode::Stroke;
use crate::profile::Settings;

/// Side of the cells in which heights are kept: about a bead's width.
const CELL_MM: f64 = 0.5;
/// Dips that are none: layers of unequal height beside each other, and those that are sunk into a raft.
const SLACK_MM: f64 = 0.15;

/// Looks whether moves pass through the print.
pub(super) struct Material {
    relief: Relief,
}

impl Material {
    pub fn new(settings: &Settings) -> Self {
        Self { relief: Relief::new(settings.bed.low_mm(), settings.bed.high_mm(), CELL_MM) }
    }
}

impl Rule for Material {
    fn see(&mut self, seen: &Seen<'_>, found: &mut Found) {
        let Some(stroke) = seen.stroke().filter(|stroke| stroke.xy_mm > 0.0) else { return };
        let slack_mm = SLACK_MM + scarf_mm(stroke, seen);
        if seen.located
            && let Some(([x, y, z], depth_mm)) = self.relief.dip(stroke, slack_mm)
        {
            seen.fault(found, Kind::ThroughPrint, || {
                format!("at X{x:.2} Y{y:.2} Z{z:.2}, {depth_mm:.2} mm deep")
            });
        }
        if stroke.extrudes() {
            self.relief.lay(stroke);
        }
    }
}

/// How deep a bead may lie beside what stands at the height of its layer, mm: a seam's scarf begins near the bottom of
/// the layer, and climbs.
fn scarf_mm(stroke: &Stroke, seen: &Seen<'_>) -> f64 {
    let below = seen.context.z_mm.is_some_and(|top_mm| stroke.from[2] < top_mm);
    let scarf = stroke.extrudes() && (below || stroke.from[2] < stroke.to[2]);
    seen.context.height_mm.filter(|_| scarf).unwrap_or(0.0)
}
