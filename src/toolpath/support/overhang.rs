//! What of a layer hangs in the air.

use std::borrow::Cow;
use std::sync::OnceLock;

use super::bitmap::{Bitmap, Grid};
use super::bridge;
use crate::toolpath::options::SupportSettings;
use geometry::real;
use geometry::{Boxes, Polygon, Region};

/// Overhangs smaller than this are noise of the section: less than a nozzle diameter.
const CRUMB_MM2: f64 = 0.05;

/// Outlines are simplified to this before they are grown: a tenth of what a layer may lean out.
pub const ROUGH_MM: f64 = 0.02;

/// The unsupported area of a layer.
#[derive(Clone, Debug)]
pub struct Overhang {
    /// Leans out too far, or is too long a bridge.
    pub leaning: Bitmap,
    /// Areas that need support at any size: islands that begin in mid-air, and enforced ones.
    pub must: Bitmap,
}

/// One layer of the plate. Its outline simplified, and its cells, are found when they are first asked for.
#[derive(Debug)]
pub struct Slab<'a> {
    grid: Grid,
    section: Cow<'a, Region>,
    boxes: OnceLock<Boxes>,
    rough: OnceLock<Region>,
    solid: OnceLock<Bitmap>,
}

impl<'a> Slab<'a> {
    /// A layer of everything solid.
    pub fn new(grid: Grid, section: Cow<'a, Region>) -> Self {
        Self { grid, section, boxes: OnceLock::new(), rough: OnceLock::new(), solid: OnceLock::new() }
    }

    /// Everything solid.
    pub fn section(&self) -> &Region {
        &self.section
    }

    /// Whether it has exactly this polygon.
    fn has(&self, polygon: &Polygon) -> bool {
        self.boxes.get_or_init(|| Boxes::of(&self.section)).find(&self.section, polygon)
    }

    /// The same, simplified to [`ROUGH_MM`].
    pub fn rough(&self) -> &Region {
        self.rough.get_or_init(|| geometry::simplify(&self.section, ROUGH_MM))
    }

    /// The same as cells.
    pub fn solid(&self) -> &Bitmap {
        self.solid.get_or_init(|| Bitmap::of(self.grid, &self.section))
    }
}

/// Support modifiers at the height of one layer: where the user enforces or blocks support.
#[derive(Clone, Copy, Debug)]
pub struct SupportModifiers<'a> {
    /// Everything that rests on nothing is held here.
    pub enforced: &'a Region,
    /// Nothing is held here.
    pub blocked: &'a Region,
}

/// Finds the part of a layer `height_mm` high that overhangs the one below by more than `support.angle`, without
/// bridges. Unless support is enabled, nothing is held but what is enforced.
pub fn find(
    layer: &Slab<'_>,
    below: &Slab<'_>,
    height_mm: f64,
    modifiers: SupportModifiers<'_>,
    settings: &SupportSettings,
) -> Overhang {
    let grid = layer.grid;
    let lean_mm = height_mm * real::tan(settings.angle.to_radians());
    let mut beyond =
        if settings.enabled { beyond(layer.section(), below, lean_mm) } else { Region::default() };
    beyond.retain(|polygon| polygon.area_mm2() >= CRUMB_MM2);
    // What nothing touches comes out of the difference as it was.
    let (islands, edges): (Vec<_>, Vec<_>) =
        beyond.into_polygons().into_iter().partition(|polygon| layer.has(polygon));

    let mut leaning = Bitmap::empty(grid);
    let mut air = Bitmap::empty(grid);
    if !(edges.is_empty() && modifiers.enforced.is_empty()) {
        air.add(layer.solid());
        air.remove(below.solid());
    }
    for polygon in edges {
        let whole = geometry::offset(&Region::from(polygon), lean_mm + ROUGH_MM);
        let mut cells = Bitmap::of(grid, &whole);
        cells.keep(&air);
        if cells.is_empty() {
            continue;
        }
        cells.remove(&bridge::spanned(&whole, below.solid(), settings.max_bridge.0));
        leaning.add(&cells);
    }
    let mut must = Bitmap::touching(grid, &Region::disjoint(islands));
    if !modifiers.enforced.is_empty() {
        air.keep(&Bitmap::of(grid, modifiers.enforced));
        must.add(&air);
    }
    if !modifiers.blocked.is_empty() {
        let blocked = Bitmap::of(grid, modifiers.blocked);
        leaning.remove(&blocked);
        must.remove(&blocked);
    }
    Overhang { leaning, must }
}

/// What reaches farther beyond the layer below than `lean_mm`.
fn beyond(section: &Region, below: &Slab<'_>, lean_mm: f64) -> Region {
    // Islands that repeat reach nowhere.
    let is_new = |polygon: &&Polygon| !below.has(polygon);
    let new = Region::disjoint(section.polygons().iter().filter(is_new).cloned());
    let reach = geometry::to_units(lean_mm) + 1;
    let boxes = Boxes::new(new.polygons().iter().map(|polygon| polygon.bounds().grown(reach)));
    let is_near = |polygon: &&Polygon| !boxes.touching(&polygon.bounds()).is_empty();
    let near = Region::disjoint(below.rough().polygons().iter().filter(is_near).cloned());
    geometry::difference(&new, &geometry::offset(&near, lean_mm))
}

/// The part of a layer's overhang that needs support: all that must be, and of what leans out the parts that, seen
/// from above together with the layers just over and under it, reach out by `support.min_reach`. `around` are those
/// layers, its own among them.
pub fn lasting<'a>(
    own: &Overhang,
    around: impl Iterator<Item = &'a Overhang>,
    settings: &SupportSettings,
) -> Bitmap {
    let grid: Grid = own.must.grid();
    let mut held = own.must.grown(1);
    if own.leaning.is_empty() {
        return held;
    }
    let mut shadow = Bitmap::empty(grid);
    around.for_each(|overhang| shadow.add(&overhang.leaning));
    let side = grid.cells(settings.min_reach.0).max(1);
    let mut wide = shadow.opened(side).grown(side);
    wide.keep(&own.leaning);
    held.add(&wide);
    held
}

/// How many layers above and below are seen together: as many as a slope at the limit takes to reach out so far.
pub fn window(height_mm: f64, settings: &SupportSettings) -> usize {
    let lean_mm = (height_mm * real::tan(settings.angle.to_radians())).max(1e-3);
    ((settings.min_reach.0 / lean_mm).ceil() as usize).min(20)
}
