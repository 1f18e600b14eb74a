//! What patterns have in common.

use std::fmt::Debug;

use super::lines;
use super::spec::{FillSpec, LineSet};
use crate::toolpath::bead::Line;
use geometry::Region;

/// A sparse infill pattern.
pub trait FillPattern: Debug + Send + Sync {
    /// The pattern's beads inside a region: the lines of its [`sets`](Self::sets), or what a pattern that has none makes
    /// itself. Beads end on its boundary and nowhere leave it.
    fn fill(&self, region: &Region, spec: &FillSpec) -> Vec<Line> {
        lines::lay(region, &self.sets(spec), &spec.joins)
    }

    /// The sets of parallel lines that it consists of; none if it is made of something else.
    fn sets(&self, _spec: &FillSpec) -> Vec<LineSet> {
        Vec::new()
    }

    /// By how much the lines of a layer are turned against those of the first one, in radians.
    fn turn_rad(&self, _layer: usize) -> f64 {
        0.0
    }

    /// Whether it is spread evenly, so that it has the density asked for wherever it is.
    fn is_even(&self) -> bool {
        true
    }

    /// Whether the lines at a multiple of the distance are among those at the distance itself, so that lines of layers
    /// with different multiples lie on each other.
    fn nests(&self) -> bool {
        false
    }
}
