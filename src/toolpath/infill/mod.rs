//! Infill: one file per pattern behind one interface.

mod adaptive_cubic;
mod aligned_rectilinear;
mod caps;
mod concentric;
mod connect;
mod cubic;
mod density;
mod grid;
mod gyroid;
mod hilbert;
mod honeycomb;
mod honeycomb_3d;
mod lightning;
pub(super) mod lines;
mod rectilinear;
mod solid;
mod trees;
mod tri_hexagon;
mod triangles;
mod waves;

use std::fmt::Debug;
use std::sync::Arc;

use crate::toolpath::options::Pattern;
use geometry::Region;

use super::bead::Line;

pub use adaptive_cubic::AdaptiveCubic;
pub use connect::Joins;
pub use density::{SOLID_DENSITY, SparseSample, calibrate, flow, lay};
pub use lightning::{Hollow, Lightning};
pub use lines::LineSet;
pub use solid::{SolidSpec, fill as fill_solid, iron, nearest_first, split_narrow, turned};

/// What a pattern needs to know of a layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FillSpec {
    /// Mean distance between beads, in millimetres: the spacing of a solid fill over the density. Patterns with
    /// several sets of lines space each set wider accordingly.
    pub line_distance_mm: f64,
    /// Distance at which two beads lie beside each other, in millimetres.
    pub spacing_mm: f64,
    /// Direction of the layer's lines, in radians from the X axis.
    pub angle_rad: f64,
    /// Index of the layer, from 0.
    pub layer: usize,
    /// Height of the layer's middle over the bed, in millimetres.
    pub z_mm: f64,
    /// What becomes of line ends.
    pub joins: Joins,
}

impl FillSpec {
    /// Only every n-th line, joined as before.
    fn sparser(&self, n: u32) -> Self {
        let n = f64::from(n);
        let joins = Joins { longest_mm: n * self.joins.longest_mm, ..self.joins };
        Self { line_distance_mm: n * self.line_distance_mm, joins, ..*self }
    }

    /// The lines as they are, none joined.
    fn apart(&self) -> Self {
        Self { joins: Joins { longest_mm: 0.0, ..self.joins }, ..*self }
    }
}

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

/// The pattern of a setting. Those that depend on more than a layer are planned by their own constructors; here they
/// know of nothing and are empty.
pub fn pattern(kind: Pattern) -> Arc<dyn FillPattern> {
    match kind {
        Pattern::Rectilinear => Arc::new(rectilinear::Rectilinear),
        Pattern::AlignedRectilinear => Arc::new(aligned_rectilinear::AlignedRectilinear),
        Pattern::Grid => Arc::new(grid::Grid),
        Pattern::Triangles => Arc::new(triangles::Triangles),
        Pattern::TriHexagon => Arc::new(tri_hexagon::TriHexagon),
        Pattern::Cubic => Arc::new(cubic::Cubic),
        Pattern::AdaptiveCubic => Arc::new(AdaptiveCubic::default()),
        Pattern::Gyroid => Arc::new(gyroid::Gyroid),
        Pattern::Honeycomb => Arc::new(honeycomb::Honeycomb),
        Pattern::Honeycomb3d => Arc::new(honeycomb_3d::Honeycomb3d),
        Pattern::Concentric => Arc::new(concentric::Concentric),
        Pattern::Lightning => Arc::new(Lightning::default()),
        Pattern::Hilbert => Arc::new(hilbert::Hilbert),
    }
}
