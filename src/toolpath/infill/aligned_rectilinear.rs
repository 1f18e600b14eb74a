//! Parallel lines in the same direction on every layer: walls of one direction, stiff along it, cheap to print.

use crate::geom::Region;

use super::super::bead::Line;
use super::{FillPattern, FillSpec, lines};

/// See the module.
#[derive(Debug)]
pub struct AlignedRectilinear;

impl FillPattern for AlignedRectilinear {
    fn fill(&self, region: &Region, spec: &FillSpec) -> Vec<Line> {
        lines::parallel(region, spec.angle_rad, spec.line_distance_mm, 0.0, &spec.joins)
    }

    fn nests(&self) -> bool {
        true
    }
}
