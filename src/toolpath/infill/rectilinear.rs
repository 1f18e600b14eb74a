//! Parallel lines, turned by 90° from layer to layer.

use std::f64::consts::FRAC_PI_2;

use crate::geom::Region;

use super::super::bead::Line;
use super::{FillPattern, FillSpec, lines};

/// See the module.
#[derive(Debug)]
pub struct Rectilinear;

impl FillPattern for Rectilinear {
    fn fill(&self, region: &Region, spec: &FillSpec) -> Vec<Line> {
        lines::parallel(region, spec.angle_rad, spec.line_distance_mm, 0.0, &spec.joins)
    }

    fn turn_rad(&self, layer: usize) -> f64 {
        if layer % 2 == 1 { FRAC_PI_2 } else { 0.0 }
    }

    fn nests(&self) -> bool {
        true
    }
}
