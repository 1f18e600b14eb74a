//! Two sets of lines at right angles in each layer.

use std::f64::consts::FRAC_PI_2;

use crate::geom::Region;

use super::super::bead::Line;
use super::{FillPattern, FillSpec, lines};

/// See the module.
#[derive(Debug)]
pub struct Grid;

impl FillPattern for Grid {
    fn fill(&self, region: &Region, spec: &FillSpec) -> Vec<Line> {
        lines::sets(region, spec, FRAC_PI_2, &[0.0; 2])
    }

    fn nests(&self) -> bool {
        true
    }
}
