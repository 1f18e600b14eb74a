//! Two sets of lines at right angles in each layer.

use std::f64::consts::FRAC_PI_2;

use super::pattern::FillPattern;

use super::spec::{FillSpec, LineSet};

use super::lines;

/// See the module.
#[derive(Debug)]
pub struct Grid;

impl FillPattern for Grid {
    fn sets(&self, spec: &FillSpec) -> Vec<LineSet> {
        lines::sets(spec, FRAC_PI_2, &[0.0; 2])
    }

    fn nests(&self) -> bool {
        true
    }
}
