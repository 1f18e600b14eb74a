//! Revolutions of a spiral: drawn without a stop, rising all along.

use super::bead::Vertex;
use super::nozzle::Nozzle;
use super::overhang::Grade;
use super::{Move, Stop};
use crate::toolpath::{Path, Rise};
use crate::units::Mm3;
use geometry::distance_mm;

impl Nozzle<'_> {
    /// Draws the vertices of a revolution, each as far below the layer's height as `rises` says. Only a revolution that does not
    /// begin where the nozzle is, the first, is travelled to.
    pub(super) fn draw_revolution(
        &mut self,
        path: &Path,
        vertices: &[Vertex],
        rises: &[Rise],
        stop: Option<Stop>,
    ) {
        let (Some(start), Some(rise)) = (vertices.first(), rises.first()) else { return };
        let top_mm = self.layer_z_mm;
        let start_mm = top_mm - rise.below_mm;
        if self.at == Some(start.at) && (self.z_mm - start_mm).abs() < 1e-6 && stop.is_none() {
            self.positioned = true;
        } else {
            self.layer_z_mm = start_mm;
            self.travel(start.at, path.island, stop);
            self.layer_z_mm = top_mm;
        }
        self.begin(path, Grade::Held);
        let speed = self.speed(path.role, Grade::Held);
        let ends = vertices.iter().zip(rises);
        for ((from, rise_from), (to, rise)) in ends.clone().zip(ends.skip(1)) {
            let area_mm2 = 0.5 * (from.area_mm2 * rise_from.flow + to.area_mm2 * rise.flow);
            self.moves.push(Move::Ramp {
                to: to.at,
                z_mm: top_mm - rise.below_mm,
                volume: Mm3(area_mm2 * distance_mm(from.at, to.at)),
                speed: self.rules.melted(speed, area_mm2),
            });
        }
        self.at = vertices.last().map(|v| v.at);
        self.z_mm = top_mm - rises.last().map_or(0.0, |rise| rise.below_mm);
        self.wipe = Vec::new();
    }
}
