//! Two sets of lines at right angles in each layer.

use std::f64::consts::FRAC_PI_2;

use crate::geom::Region;

use super::super::bead::Line;
use super::{FillPattern, FillSpec, lines};

/// See the module.
pub struct Grid;

impl FillPattern for Grid {
    fn fill(&self, region: &Region, spec: &FillSpec) -> Vec<Line> {
        lines::sets(region, spec, 2, FRAC_PI_2)
    }

    fn nests(&self) -> bool {
        true
    }
}
