//! Three sets of lines at 60° in each layer, through common points.

use std::f64::consts::FRAC_PI_3;

use crate::geom::Region;

use super::super::bead::Line;
use super::{FillPattern, FillSpec, lines};

/// See the module.
#[derive(Debug)]
pub struct Triangles;

impl FillPattern for Triangles {
    fn fill(&self, region: &Region, spec: &FillSpec) -> Vec<Line> {
        lines::sets(region, spec, FRAC_PI_3, &[0.0; 3])
    }

    fn nests(&self) -> bool {
        true
    }
}
