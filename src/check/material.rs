//! Moves of the nozzle through what has been printed.

use super::fault::Kind;
use super::relief::Relief;
use super::report::Found;
use super::rule::{LineContext, Rule};
use crate::gcode::{Context, Stroke};
use crate::profile::Settings;

/// Side of the cells in which heights are kept: about a bead's width.
const CELL_MM: f64 = 0.5;
/// Dips that are none: layers of unequal height beside each other, and those that are sunk into a raft.
const SLACK_MM: f64 = 0.15;

/// Checks that no move passes through the print.
pub(super) struct Material {
    relief: Relief,
}

impl Material {
    pub fn new(settings: &Settings) -> Self {
        Self { relief: Relief::new(settings.bed.low_mm(), settings.bed.high_mm(), CELL_MM) }
    }
}

impl Rule for Material {
    fn check_line(&mut self, seen: &LineContext<'_>, found: &mut Found) {
        let Some(stroke) = seen.stroke().filter(|stroke| stroke.xy_mm > 0.0) else { return };
        let slack_mm = SLACK_MM + seen.bead().map_or(0.0, |bead| scarf_mm(bead, seen.context));
        if seen.located
            && let Some(([x, y, z], depth_mm)) = self.relief.dip(stroke, slack_mm)
        {
            seen.fault(found, Kind::ThroughPrint, || {
                format!("at X{x:.2} Y{y:.2} Z{z:.2}, {depth_mm:.2} mm deep")
            });
        }
        // What a script purges is thin, or beside the bed: vendors lead the nozzle through it.
        if stroke.extrudes() && !seen.in_script {
            self.relief.lay(stroke);
        }
    }
}

/// How far a bead may lie below what stands beside it on its own layer, mm: a seam's scarf begins near the bottom of the
/// layer, and climbs. Where the layer's height is not known, a bead that climbs may be one.
fn scarf_mm(bead: &Stroke, context: &Context) -> f64 {
    let below_mm = match context.z_mm {
        Some(top_mm) => top_mm - bead.from[2],
        None if bead.from[2] < bead.to[2] => f64::INFINITY,
        None => 0.0,
    };
    below_mm.min(context.height_mm.unwrap_or(0.0)).max(0.0)
}
