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

    /// Rotation of a layer's lines against those of the first layer, radians.
    fn rotation_rad(&self, _layer: usize) -> f64 {
        0.0
    }

    /// Whether its density is the requested one everywhere.
    fn is_uniform(&self) -> bool {
        true
    }

    /// Whether the lines at a multiple of the distance are among those at the distance itself, so that lines of layers
    /// with different multiples lie on each other.
    fn nests(&self) -> bool {
        false
    }
}
