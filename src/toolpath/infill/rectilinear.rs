//! Parallel lines, turned by 90° from layer to layer.

use std::f64::consts::FRAC_PI_2;

use crate::geom::Region;

use super::super::bead::Line;
use super::{FillPattern, FillSpec, lines};

/// See the module.
pub struct Rectilinear;

impl FillPattern for Rectilinear {
    fn fill(&self, region: &Region, spec: &FillSpec) -> Vec<Line> {
        let angle_rad = spec.angle_rad + if spec.layer % 2 == 1 { FRAC_PI_2 } else { 0.0 };
        lines::parallel(region, angle_rad, spec.line_distance_mm, 0.0, &spec.joins)
    }

    fn nests(&self) -> bool {
        true
    }
}
