//! Which part of a layer is solid: where a layer within the shell's thickness, above or below, is missing.

use crate::geom::{self, Region};

/// Area below which solid or sparse crumbs of an island are given to the other zone, mm² for each mm of boundary.
const CRUMB_MM: f64 = 0.02;

/// Calls a function for 0, 1, … n − 1, possibly in parallel, and returns the results in order.
pub type Map<'a> = &'a dyn Fn(usize, &(dyn Fn(usize) -> Region + Sync)) -> Vec<Region>;

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
        let below = windows(sections, bottom_layers, map);
        let above = if top_layers == bottom_layers { Vec::new() } else { windows(sections, top_layers, map) };
        Self { above, below, top_layers, bottom_layers }
    }

    /// What layer `i`'s upper neighbours have in common; `None` where no shell is asked for.
    pub fn above(&self, i: usize) -> Option<&Region> {
        let windows = if self.top_layers == self.bottom_layers { &self.below } else { &self.above };
        (self.top_layers > 0).then(|| windows.get(i + 1).unwrap_or(&EMPTY))
    }

    /// What layer `i`'s lower neighbours have in common; `None` where no shell is asked for.
    pub fn below(&self, i: usize) -> Option<&Region> {
        (self.bottom_layers > 0).then(|| match i.checked_sub(self.bottom_layers) {
            Some(first) => self.below.get(first).unwrap_or(&EMPTY),
            None => &EMPTY,
        })
    }
}

static EMPTY: Region = Region { polygons: Vec::new() };

/// Intersections of `length` consecutive sections, from each index at which that many are left.
fn windows(sections: &[&Region], length: usize, map: Map<'_>) -> Vec<Region> {
    if length == 0 || sections.len() < length {
        return Vec::new();
    }
    let mut have = 1;
    let mut level: Vec<Region> = Vec::new();
    let at = |level: &[Region], i: usize| -> Region {
        if level.is_empty() { sections[i].clone() } else { level[i].clone() }
    };
    if length == 1 {
        return (0..sections.len()).map(|i| at(&level, i)).collect();
    }
    while have < length {
        let step = have.min(length - have);
        let next = {
            let view = |i: usize| if level.is_empty() { sections[i] } else { &level[i] };
            map(sections.len() - have - step + 1, &|i| geom::intersection(view(i), view(i + step)))
        };
        level = next;
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
}

/// Divides the inside of an island into sparse, solid and top.
///
/// `above` and `below` are the windows of [`Shells`], `next` is the section of the layer above (empty on the
/// last). Solid strips too narrow for a line are left to the walls beside them; sparse ones become solid.
pub fn divide(
    inside: &Region,
    above: Option<&Region>,
    below: Option<&Region>,
    next: &Region,
    line_mm: f64,
) -> Zones {
    let common = |region: Region, window: Option<&Region>| match window {
        Some(window) => geom::intersection(&region, window),
        None => region,
    };
    let sparse = common(common(inside.clone(), above), below);
    let crumb_mm2 = CRUMB_MM * inside.rings().map(|r| geom::ring_length_mm(r)).sum::<f64>();
    let (inside_mm2, sparse_mm2) = (inside.area_mm2(), sparse.area_mm2());
    if inside_mm2 - sparse_mm2 < crumb_mm2.min(0.5 * inside_mm2) {
        return Zones { sparse: inside.clone(), ..Zones::default() };
    }
    let solid = if sparse_mm2 < crumb_mm2 {
        inside.clone()
    } else {
        let strips = geom::opening(&geom::difference(inside, &sparse), line_mm / 4.0);
        geom::intersection(&geom::offset(&strips, line_mm / 2.0), inside)
    };
    let sparse = geom::opening(&geom::difference(inside, &solid), line_mm);
    let solid = geom::difference(inside, &sparse);
    let exposed = match above {
        Some(_) => geom::opening(&geom::difference(&solid, next), line_mm / 2.0),
        None => Region::default(),
    };
    let top = geom::intersection(&geom::offset(&exposed, line_mm / 2.0), &solid);
    let solid =
        if top.is_empty() { solid } else { geom::opening(&geom::difference(&solid, &top), line_mm / 8.0) };
    Zones { sparse, solid, top }
}
