//! Which part of a layer is solid: where a layer within the shell's thickness, above or below, is missing.

use crate::geom::{self, Region};
use crate::profile::ShellSettings;

/// Area below which what an island has of a zone is given to the other zone: less than a nozzle's bore.
const CRUMB_MM2: f64 = 0.05;

/// Solid patches smaller than this many squared lines are dropped: the walls and the lines beside them close the hole.
const SMALLEST_PATCH: f64 = 0.5;

/// Solid strips narrower than this many lines are left to the walls beside them.
const NARROWEST_STRIP: f64 = 0.25;

/// Outlines are simplified to this before they are intersected: zones are anchored by half a line anyway, and the
/// cost of an intersection grows with its vertices.
const ROUGH_MM: f64 = 0.05;

/// Calls a function for 0, 1, … n − 1, possibly in parallel, and returns the results in order.
pub type Map<'a> = &'a dyn Fn(usize, &(dyn Fn(usize) -> Region + Sync)) -> Vec<Region>;

/// How many layers the top and the bottom shell have, with as many more as their least thickness asks for. A shell
/// that is not wanted stays away.
pub fn shell_layers(settings: &ShellSettings, height_mm: f64) -> (u32, u32) {
    let least = (settings.min_thickness.0 / height_mm - 1e-9).ceil().max(0.0) as u32;
    let layers = |wanted: u32| if wanted == 0 { 0 } else { wanted.max(least) };
    (layers(settings.top_layers), layers(settings.bottom_layers))
}

/// For each layer, what is common to the `top_layers` layers above it and to the `bottom_layers` below it.
#[derive(Clone, Debug, Default)]
pub struct Shells {
    above: Vec<Region>,
    below: Vec<Region>,
    top_layers: usize,
    bottom_layers: usize,
}

impl Shells {
    /// Builds the windows of one object from its sections, bottom up.
    ///
    /// Windows of a power of two are combined from halves, so the cost is about log₂(layers) + 1
    /// intersections of neighbouring layers for each layer, and top and bottom share them.
    pub fn build(sections: &[&Region], top_layers: u32, bottom_layers: u32, map: Map<'_>) -> Self {
        let (top_layers, bottom_layers) = (top_layers as usize, bottom_layers as usize);
        let rough = map(sections.len(), &|i| geom::simplify(sections[i], ROUGH_MM));
        let below = windows(&rough, bottom_layers, map);
        let above = if top_layers == bottom_layers { Vec::new() } else { windows(&rough, top_layers, map) };
        Self { above, below, top_layers, bottom_layers }
    }

    /// What layer `i`'s upper neighbours have in common; `None` where no shell is asked for.
    pub fn above(&self, i: usize) -> Option<&Region> {
        let windows = if self.top_layers == self.bottom_layers { &self.below } else { &self.above };
        (self.top_layers > 0).then(|| windows.get(i + 1).unwrap_or(Region::EMPTY))
    }

    /// What layer `i`'s lower neighbours have in common; `None` where no shell is asked for.
    pub fn below(&self, i: usize) -> Option<&Region> {
        (self.bottom_layers > 0).then(|| match i.checked_sub(self.bottom_layers) {
            Some(first) => self.below.get(first).unwrap_or(Region::EMPTY),
            None => Region::EMPTY,
        })
    }
}

/// Intersections of `length` consecutive sections, from each index at which that many are left.
fn windows(sections: &[Region], length: usize, map: Map<'_>) -> Vec<Region> {
    if length == 0 || sections.len() < length {
        return Vec::new();
    }
    let mut level = sections.to_vec();
    let mut have = 1;
    while have < length {
        let step = have.min(length - have);
        level = map(level.len() - step, &|i| geom::intersection(&level[i], &level[i + step]));
        have += step;
    }
    level
}

/// The inside of an island, divided.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Zones {
    /// Filled by the sparse pattern.
    pub sparse: Region,
    /// Solid, with material above.
    pub solid: Region,
    /// Solid, with nothing above.
    pub top: Region,
    /// Area of what no shell covers, in square millimetres: what sparse infill owes its density to. The sparse zone
    /// itself differs by what solid infill anchors in and by places too narrow for either.
    pub sparse_mm2: f64,
}

/// Divides the inside of an island into sparse, solid and top.
///
/// `above` and `below` are the windows of [`Shells`], `next` is the section of the layer above (empty on the
/// last). Very narrow solid strips are left to the walls beside them; sparse ones become solid.
pub fn divide(
    inside: &Region,
    above: Option<&Region>,
    below: Option<&Region>,
    next: &Region,
    line_mm: f64,
) -> Zones {
    let common = |region: &Region, window: Option<&Region>| match window {
        Some(window) => geom::intersection(region, window),
        None => region.clone(),
    };
    let roofed = common(inside, above);
    let sparse = common(&roofed, below);
    let (inside_mm2, sparse_mm2) = (inside.area_mm2(), sparse.area_mm2());
    let all_sparse = || Zones { sparse: inside.clone(), sparse_mm2, ..Zones::default() };
    if inside_mm2 - sparse_mm2 < CRUMB_MM2.min(0.5 * inside_mm2) {
        return all_sparse();
    }
    let (sparse, solid) = if sparse_mm2 < CRUMB_MM2 {
        (Region::default(), inside.clone())
    } else {
        let mut strips = geom::opening(&geom::difference(inside, &sparse), NARROWEST_STRIP / 2.0 * line_mm);
        strips.polygons.retain(|patch| patch.area_mm2() >= SMALLEST_PATCH * line_mm * line_mm);
        if strips.is_empty() {
            return all_sparse();
        }
        let anchored = geom::offset(&strips, line_mm / 2.0);
        let sparse = geom::opening(&geom::difference(inside, &anchored), line_mm / 2.0);
        let solid = geom::difference(inside, &sparse);
        (sparse, solid)
    };
    // What has a roof of the whole shell's thickness has one on the next layer.
    if inside_mm2 - roofed.area_mm2() < CRUMB_MM2 {
        return Zones { sparse, solid, top: Region::default(), sparse_mm2 };
    }
    let exposed = geom::opening(&geom::difference(&solid, next), line_mm / 2.0);
    if exposed.is_empty() {
        return Zones { sparse, solid, top: exposed, sparse_mm2 };
    }
    let around = geom::offset(&exposed, line_mm / 2.0);
    let top = geom::intersection(&around, &solid);
    let solid = geom::difference(&solid, &around);
    Zones { sparse, solid, top, sparse_mm2 }
}
