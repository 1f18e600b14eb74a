//! Infill: one file per pattern behind one interface.

mod concentric;
mod connect;
mod density;
mod grid;
mod gyroid;
pub(super) mod lines;
mod rectilinear;
mod solid;
mod triangles;

use crate::geom::{Point, Region};
use crate::profile::Pattern;

pub use density::{SparseSample, calibrate, flow, lay};
pub use solid::fill as fill_solid;

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
    /// Line ends are joined along the boundary where that way is at most this long, in millimetres.
    pub connect_mm: f64,
}

impl FillSpec {
    /// Only every n-th line, joined as before.
    fn sparser(&self, n: u32) -> Self {
        let n = f64::from(n);
        Self { line_distance_mm: n * self.line_distance_mm, connect_mm: n * self.connect_mm, ..*self }
    }
}

/// One infill bead.
#[derive(Clone, Debug, PartialEq)]
pub struct FillLine {
    /// Vertices.
    pub points: Vec<Point>,
    /// Whether it returns to its first vertex.
    pub closed: bool,
}

/// A sparse infill pattern.
pub trait FillPattern: Sync {
    /// The pattern's beads inside a region. Beads end on its boundary and nowhere leave it.
    fn fill(&self, region: &Region, spec: &FillSpec) -> Vec<FillLine>;

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
