//! Three sets of lines at 60° in each layer, through common points.

use std::f64::consts::FRAC_PI_3;

use super::pattern::FillPattern;

use super::spec::{FillSpec, LineSet};

use super::lines;

/// See the module.
#[derive(Debug)]
pub struct Triangles;

impl FillPattern for Triangles {
    fn sets(&self, spec: &FillSpec) -> Vec<LineSet> {
        lines::sets(spec, FRAC_PI_3, &[0.0; 3])
    }

    fn nests(&self) -> bool {
        true
    }
}
