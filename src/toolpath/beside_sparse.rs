//! Small beads in gaps beside sparse infill: in the tips of its area they close nothing, and cost a travel each.

use std::cell::LazyCell;

use geometry::{EdgeGrid, Point};

use super::path::{Path, Role};
use super::shells::Zones;

/// A bead that covers less than this is small.
const SMALL_MM2: f64 = 0.2;

/// A bead is beside an area that is at most this many spacings of lines away.
const BESIDE: f64 = 1.5;

/// Leaves out the small gap beads of an island, from path `first` on, that lie beside its sparse infill and beside nothing
/// solid.
pub(super) fn leave_out(paths: &mut Vec<Path>, first: usize, zones: &Zones, spacing_mm: f64) {
    let sparse = LazyCell::new(|| EdgeGrid::new(&zones.sparse));
    let solid = LazyCell::new(|| [&zones.solid, &zones.top].map(EdgeGrid::new));
    let reach_mm = BESIDE * spacing_mm;
    let beside = |area: &EdgeGrid, p: Point| area.distance_mm(p, reach_mm) < reach_mm || area.contains(p);
    let is_needless = |path: &Path| {
        path.role == Role::GapFill
            && covers_less(path, SMALL_MM2)
            && path.points.iter().all(|&p| beside(&sparse, p) && !solid.iter().any(|area| beside(area, p)))
    };
    let own = paths.split_off(first);
    paths.extend(own.into_iter().filter(|path| !is_needless(path)));
}

fn covers_less(path: &Path, mm2: f64) -> bool {
    geometry::polyline_length_mm(&path.points) * path.width.widest_mm() < mm2
}
