//! Two sets of lines at right angles in each layer.

use std::f64::consts::FRAC_PI_2;

use crate::geom::Region;

use super::{FillLine, FillPattern, FillSpec, lines};

/// See the module.
pub struct Grid;

impl FillPattern for Grid {
    fn fill(&self, region: &Region, spec: &FillSpec) -> Vec<FillLine> {
        let set = |k: usize| {
            let angle_rad = spec.angle_rad + k as f64 * FRAC_PI_2;
            lines::parallel(region, angle_rad, 2.0 * spec.line_distance_mm, 0.0, spec.connect_mm)
        };
        (0..2).flat_map(set).collect()
    }
}
