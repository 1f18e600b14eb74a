//! Parallel lines in the same direction on every layer: walls of one direction, stiff along it, cheap to print.

use super::pattern::FillPattern;

use super::spec::{FillSpec, LineSet};

use super::lines;

/// See the module.
#[derive(Debug)]
pub struct AlignedRectilinear;

impl FillPattern for AlignedRectilinear {
    fn sets(&self, spec: &FillSpec) -> Vec<LineSet> {
        lines::sets(spec, 0.0, &[0.0])
    }

    fn nests(&self) -> bool {
        true
    }
}
