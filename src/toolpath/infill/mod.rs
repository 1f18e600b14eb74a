//! Infill: one file per pattern behind one interface.

mod caps;
mod concentric;
mod connect;
mod density;
mod grid;
mod gyroid;
pub(super) mod lines;
mod rectilinear;
mod solid;
mod triangles;

use crate::geom::Region;
use crate::profile::Pattern;

use super::bead::Line;

pub use connect::Joins;
pub use density::{SparseSample, calibrate, flow, lay};
pub use solid::{SolidSpec, fill as fill_solid, iron, split_narrow};

/// What a pattern needs to know of a layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FillSpec {
    /// Mean distance between beads, in millimetres: the spacing of a solid fill over the density. Patterns with
    /// several sets of lines space each set wider accordingly.
    pub line_distance_mm: f64,
    /// Direction of the first layer's lines, in radians from the X axis.
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
pub trait FillPattern: Sync {
    /// The pattern's beads inside a region. Beads end on its boundary and nowhere leave it.
    fn fill(&self, region: &Region, spec: &FillSpec) -> Vec<Line>;

    /// Whether the lines at a multiple of the distance are among those at the distance itself, so that lines of layers
    /// with different multiples lie on each other.
    fn nests(&self) -> bool {
        false
    }
}

/// The pattern of a setting.
pub fn pattern(kind: Pattern) -> &'static dyn FillPattern {
    match kind {
        Pattern::Rectilinear => &rectilinear::Rectilinear,
        Pattern::Grid => &grid::Grid,
        Pattern::Triangles => &triangles::Triangles,
        Pattern::Gyroid => &gyroid::Gyroid,
        Pattern::Concentric => &concentric::Concentric,
    }
}
