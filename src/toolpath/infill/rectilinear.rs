//! Parallel lines, turned by 90° from layer to layer.

use std::f64::consts::FRAC_PI_2;

use super::pattern::FillPattern;

use super::spec::{FillSpec, LineSet};

use super::lines;

/// See the module.
#[derive(Debug)]
pub struct Rectilinear;

impl FillPattern for Rectilinear {
    fn sets(&self, spec: &FillSpec) -> Vec<LineSet> {
        lines::sets(spec, 0.0, &[0.0])
    }

    fn rotation_rad(&self, layer: usize) -> f64 {
        if layer % 2 == 1 { FRAC_PI_2 } else { 0.0 }
    }

    fn nests(&self) -> bool {
        true
    }
}
