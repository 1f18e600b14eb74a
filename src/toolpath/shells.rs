//! Which part of a layer is solid: where a layer within the shell's thickness, above or below, is missing.

use geometry::Region;

use super::reach::Reach;
use super::shell_windows::{ROUGH_MM, Window};

/// Area below which what an island has of a zone is given to the other zone: less than a nozzle diameter.
const CRUMB_MM2: f64 = 0.05;

/// Solid patches smaller than this many squared lines are dropped: the walls and the lines beside them close the hole.
const SMALLEST_PATCH: f64 = 0.5;

/// Solid strips narrower than this many lines are left to the walls beside them.
const NARROWEST_STRIP: f64 = 0.25;

/// The inside an island, divided.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Zones {
    /// Filled by the sparse pattern.
    pub sparse: Region,
    /// Solid, with material above.
    pub solid: Region,
    /// Solid, with nothing above.
    pub top: Region,
    /// Area outside of all shells, in square millimetres, to which the density of sparse infill refers. The sparse
    /// zone itself differs by what solid infill anchors in and by places too narrow for either.
    pub sparse_mm2: f64,
}

impl Zones {
    /// Makes patches of the sparse zone up to this size solid.
    pub fn fill_small(&mut self, most_mm2: f64) {
        let (small, large): (Vec<_>, Vec<_>) =
            self.sparse.polygons().iter().cloned().partition(|polygon| polygon.area_mm2() <= most_mm2);
        if small.is_empty() {
            return;
        }
        self.solid = geometry::union(&self.solid, &Region::disjoint(small));
        self.leave_sparse(Region::disjoint(large));
    }

    /// Limits the sparse zone to this area, and the area its density refers to accordingly.
    pub fn leave_sparse(&mut self, sparse: Region) {
        let taken_mm2 = self.sparse.area_mm2() - sparse.area_mm2();
        self.sparse_mm2 = (self.sparse_mm2 - taken_mm2).max(0.0);
        self.sparse = sparse;
    }
}

/// Divides the inside an island into sparse, solid and top.
///
/// `above` and `below` are the windows of [`Shells`](super::Shells), `next` is the section of the layer above (empty on the
/// last). Very narrow solid strips are left to the walls beside them; sparse ones become solid. Solid patches `reach`
/// over a line of sparse infill beneath. A surface continues under ribs that rise out of it and are narrower than twice
/// `walls_mm`: their walls stand on it, and not on sparse infill or a patch of their own.
pub fn divide(
    inside: &Region,
    above: Option<Window<'_>>,
    below: Option<Window<'_>>,
    next: &Region,
    line_mm: f64,
    walls_mm: f64,
    reach: Option<&Reach<'_>>,
) -> Zones {
    let parted = |region: &Region, window: Option<Window<'_>>| match window {
        Some(window) if window.surely_holds(region) => (region.clone(), Region::default()),
        Some(window) => geometry::split(region, window.region()),
        None => (region.clone(), Region::default()),
    };
    let (roofed, mut bare) = parted(inside, above);
    let (common, unsupported) = parted(&roofed, below);
    let (inside_mm2, sparse_mm2) = (inside.area_mm2(), common.area_mm2());
    let all_sparse = || Zones { sparse: inside.clone(), sparse_mm2, ..Zones::default() };
    if inside_mm2 - sparse_mm2 < CRUMB_MM2.min(0.5 * inside_mm2) {
        return all_sparse();
    }
    let (sparse, solid) = if sparse_mm2 < CRUMB_MM2 {
        (Region::default(), inside.clone())
    } else {
        bare.add_disjoint(unsupported.into_polygons());
        let mut strips = geometry::opening(&bare, NARROWEST_STRIP / 2.0 * line_mm);
        strips.retain(|patch| patch.area_mm2() >= SMALLEST_PATCH * line_mm * line_mm);
        if strips.is_empty() {
            return all_sparse();
        }
        if let Some(reach) = reach {
            strips = reach.grow(strips, inside, line_mm);
        }
        let anchored = geometry::offset(&strips, line_mm / 2.0);
        let sparse = geometry::opening(&geometry::difference(inside, &anchored), line_mm / 2.0);
        let solid = geometry::remainder(inside, &sparse);
        (sparse, solid)
    };
    // What has a roof of the whole shell's thickness has one on the next layer.
    if inside_mm2 - roofed.area_mm2() < CRUMB_MM2 {
        return Zones { sparse, solid, top: Region::default(), sparse_mm2 };
    }
    let exposed = geometry::opening(&geometry::difference(&solid, next), line_mm / 2.0);
    if exposed.is_empty() {
        return Zones { sparse, solid, top: exposed, sparse_mm2 };
    }
    let ribs = under_ribs(inside, &exposed, next, line_mm, walls_mm);
    let mut zones = Zones { sparse, solid, top: exposed, sparse_mm2 };
    if !ribs.is_empty() {
        zones.leave_sparse(geometry::opening(&geometry::difference(&zones.sparse, &ribs), line_mm / 2.0));
        zones.solid = geometry::remainder(inside, &zones.sparse);
        zones.top = geometry::union(&zones.top, &ribs);
    }
    (zones.top, zones.solid) = geometry::split(&zones.solid, &geometry::offset(&zones.top, line_mm / 2.0));
    zones
}

/// The part of an inside under the walls of a rib that rises out of a surface: beside exposed parts, where the next layer is too
/// narrow for anything but walls.
fn under_ribs(inside: &Region, exposed: &Region, next: &Region, line_mm: f64, walls_mm: f64) -> Region {
    let rough = |region: &Region| geometry::simplify(region, ROUGH_MM);
    let around = geometry::intersection(inside, &geometry::offset(&rough(exposed), 2.0 * walls_mm));
    let beside = geometry::difference(&around, exposed);
    if beside.is_empty() {
        return beside;
    }
    let wide = geometry::opening(&rough(next), walls_mm);
    geometry::opening(&geometry::difference(&beside, &wide), line_mm / 2.0)
}
