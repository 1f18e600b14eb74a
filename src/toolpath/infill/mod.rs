//! Infill: one file per pattern behind one interface.

mod adaptive_cubic;
mod aligned_rectilinear;
mod angle;
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
mod monotone;
mod pattern;
mod rectilinear;
mod solid;
mod spec;
mod trees;
mod tri_hexagon;
mod triangles;
mod waves;

use std::sync::Arc;

use crate::toolpath::options::Pattern;

pub use adaptive_cubic::AdaptiveCubic;
pub(super) use angle::fewest_turns;
pub use density::{SOLID_DENSITY, SparseSample, calibrate, flow, lay};
pub use lightning::{Lightning, LightningLayer};
pub use monotone::monotone;
pub use pattern::FillPattern;
pub use solid::{SolidSpec, fill as fill_solid, iron, split_narrow, turned};
pub use spec::{FillSpec, Joins, LineSet};

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
