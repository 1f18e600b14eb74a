//! Three sets of lines at 60° in each layer, through common points.

use std::f64::consts::FRAC_PI_3;

use crate::geom::Region;

use super::{FillLine, FillPattern, FillSpec, lines};

/// See the module.
pub struct Triangles;

impl FillPattern for Triangles {
    fn fill(&self, region: &Region, spec: &FillSpec) -> Vec<FillLine> {
        let set = |k: usize| {
            let angle_rad = spec.angle_rad + k as f64 * FRAC_PI_3;
            lines::parallel(region, angle_rad, 3.0 * spec.line_distance_mm, 0.0, spec.connect_mm)
        };
        (0..3).flat_map(set).collect()
    }
}
