//! The order of heights: layers go up, but for objects that are printed one after the other.

use super::fault::Kind;
use super::report::Found;
use super::rule::{LineContext, Rule};
use crate::profile::Settings;

/// Walls printed for several layers before their infill, and slopes, go down by less than this many nozzle diameters.
const SLACK_NOZZLES: f64 = 1.5;

/// Checks the order of heights.
pub(super) struct Heights {
    top_mm: f64,
    slack_mm: f64,
}

impl Heights {
    pub fn new(settings: &Settings) -> Self {
        Self { top_mm: f64::NEG_INFINITY, slack_mm: SLACK_NOZZLES * settings.printer.nozzle_diameter.0 }
    }
}

impl Rule for Heights {
    fn check_line(&mut self, seen: &LineContext<'_>, found: &mut Found) {
        let Some(bead) = seen.bead() else {
            if seen.another_object() {
                self.top_mm = f64::NEG_INFINITY;
            }
            return;
        };
        // A script purges at the height that its printer's vendor has found to be right.
        if seen.in_script {
            return;
        }
        let z_mm = bead.to[2];
        if z_mm < self.top_mm - self.slack_mm - 1e-6 {
            let top_mm = self.top_mm;
            seen.fault(found, Kind::HeightOrder, || format!("Z{z_mm:.3} after Z{top_mm:.3}"));
        }
        self.top_mm = self.top_mm.max(z_mm);
    }
}
