//! Three sets of lines at 60° in each layer, through common points.

use std::f64::consts::FRAC_PI_3;

use crate::geom::Region;

use super::{FillLine, FillPattern, FillSpec, lines};

/// See the module.
pub struct Triangles;

impl FillPattern for Triangles {
    fn fill(&self, region: &Region, spec: &FillSpec) -> Vec<FillLine> {
        lines::sets(region, spec, 3, FRAC_PI_3)
    }

    fn nests(&self) -> bool {
        true
    }
}
