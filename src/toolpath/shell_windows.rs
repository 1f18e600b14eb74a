//! Which layers decide where shells are, and what those layers have in common.
//!
//! Most islands lie well inside all layers that their shells depend on. That shows on cells; what these layers have in common
//! is found only where it does not.

use std::ops::Range;
use std::sync::OnceLock;

use super::options::ShellSettings;
use super::shell_depth::{above, below};
use super::support::{Grid, Within};
use geometry::{Bounds, Region};

/// Calls a function for 0, 1, … n − 1, possibly in parallel, and returns the results in order.
pub type Map<'a> = &'a dyn Fn(usize, &(dyn Fn(usize) -> Region + Sync)) -> Vec<Region>;

/// Outlines are simplified to this before they are intersected: zones are anchored by half a line anyway, and the
/// cost of an intersection grows with its vertices.
pub(super) const ROUGH_MM: f64 = 0.05;

/// Side of a cell. With the cells at its edges left out, what lies behind two walls still shows to be inside of layers that do
/// not lean; smaller cells show it in more layers, but take longer than they save.
const CELL_MM: f64 = 0.4;

/// Cells of all layers together, at most: 16 MB.
const MOST_CELLS: f64 = 128e6;

/// Room around the layers.
const MARGIN_MM: f64 = 1.0;

/// Outlines inside an area are looked for as long as that passes no more vertices than this.
const MOST_PASSED: usize = 20_000;

/// The intersection of the layers within a shell's thickness; the shell is what lies outside of it.
#[derive(Clone, Copy, Debug, Default)]
pub struct ShellWindows<'a> {
    /// Of the layers above, as many as the top shell is thick; `None`: no top shell.
    pub top: Option<Window<'a>>,
    /// Of the layers below, as many as the bottom shell is thick; `None`: no bottom shell.
    pub bottom: Option<Window<'a>>,
}

/// An intersection of layers, found when it is asked for.
#[derive(Clone, Copy, Debug)]
pub enum Window<'a> {
    /// Nothing: it reaches beyond the object.
    Nothing,
    /// One of these, by its number.
    Of(&'a Shells, usize),
}

impl<'a> Window<'a> {
    /// The area.
    pub fn region(self) -> &'a Region {
        match self {
            Self::Nothing => Region::EMPTY,
            Self::Of(shells, window) => shells.window(window),
        }
    }

    /// Whether a region shows on cells to lie inside, apart from the boundary. Others may do, too.
    pub(super) fn surely_holds(self, region: &Region) -> bool {
        match self {
            Self::Nothing => region.is_empty(),
            Self::Of(shells, window) => {
                region.is_empty() || shells.hold(shells.ranges[window].clone(), region)
            }
        }
    }
}

/// For each layer, the intersection of the layers above it within the top shell's thickness, and of those below it
/// within the bottom shell's.
#[derive(Clone, Debug, Default)]
pub struct Shells {
    /// The layers, simplified.
    sections: Vec<Region>,
    /// Intersections of 2, 4, 8 … consecutive sections, from each at which that many are left.
    common: Vec<Vec<OnceLock<Region>>>,
    /// Which sections each window is of, and the windows.
    ranges: Vec<Range<usize>>,
    windows: Vec<OnceLock<Region>>,
    /// For each layer its window; `None`: it reaches beyond the object.
    above: Vec<Option<usize>>,
    below: Vec<Option<usize>>,
    has_top: bool,
    has_bottom: bool,
    /// For each section the first one of those beneath, itself or all in between, that it equals.
    like: Vec<usize>,
    /// The cells within each section; none of nothing.
    grid: Option<Grid>,
    within: Vec<OnceLock<Within>>,
}

impl Shells {
    /// The windows of one object from its sections and the layers' heights, bottom up.
    ///
    /// Windows of a power of two are combined from halves, others from two that overlap, so the cost of all would be about
    /// log₂(layers) + 1 intersections of neighbouring layers for each layer, and top and bottom share them.
    pub fn build(sections: &[&Region], heights_mm: &[f64], settings: &ShellSettings, map: Map<'_>) -> Self {
        let count = sections.len();
        let up = |i: usize| i + 1..i + 1 + above(heights_mm, i, settings);
        let down = |i: usize| Some(i.checked_sub(below(heights_mm, i, settings))?..i);
        let inside = |range: &Range<usize>| !range.is_empty() && range.end <= count;
        let above: Vec<_> = (0..count).map(|i| Some(up(i)).filter(inside)).collect();
        let below: Vec<_> = (0..count).map(|i| down(i).filter(inside)).collect();
        let mut ranges: Vec<Range<usize>> = above.iter().chain(&below).flatten().cloned().collect();
        ranges.sort_unstable_by_key(|range| (range.start, range.end));
        ranges.dedup();
        let index_of = |range: &Option<Range<usize>>| {
            let range = range.as_ref()?;
            ranges.binary_search_by_key(&(range.start, range.end), |r| (r.start, r.end)).ok()
        };
        let (above, below) = (above.iter().map(index_of).collect(), below.iter().map(index_of).collect());
        let sections = map(count, &|i| geometry::simplify(sections[i], ROUGH_MM));
        let longest = ranges.iter().map(Range::len).max().unwrap_or(1);
        let unknown = |n: usize| (0..n).map(|_| OnceLock::new()).collect();
        let common = (1..=longest.ilog2()).map(|level| unknown((count + 1).saturating_sub(1 << level)));
        let mut like: Vec<usize> = (0..count).collect();
        (1..count).filter(|&i| sections[i] == sections[i - 1]).for_each(|i| like[i] = like[i - 1]);
        let bounds = sections.iter().filter_map(Region::bounds).reduce(|a, b| a.joined(&b));
        Self {
            common: common.collect(),
            windows: unknown(ranges.len()),
            above,
            below,
            has_top: settings.top_layers > 0,
            has_bottom: settings.bottom_layers > 0,
            like,
            grid: bounds.map(|bounds| grid(bounds, count)),
            within: (0..count).map(|_| OnceLock::new()).collect(),
            sections,
            ranges,
        }
    }

    /// The windows of layer `i`.
    pub fn windows(&self, i: usize) -> ShellWindows<'_> {
        let window = |indices: &[Option<usize>]| {
            indices.get(i).copied().flatten().map_or(Window::Nothing, |index| Window::Of(self, index))
        };
        ShellWindows {
            top: self.has_top.then(|| window(&self.above)),
            bottom: self.has_bottom.then(|| window(&self.below)),
        }
    }

    fn window(&self, window: usize) -> &Region {
        let Range { start, end } = self.ranges[window];
        let level = (end - start).ilog2();
        match 1 << level {
            length if length == end - start => self.common(level, start),
            length => self.windows[window].get_or_init(|| {
                geometry::intersection(self.common(level, start), self.common(level, end - length))
            }),
        }
    }

    /// The intersection of 2 to the power of `level` sections.
    fn common(&self, level: u32, first: usize) -> &Region {
        let Some(halves) = level.checked_sub(1) else { return &self.sections[first] };
        self.common[halves as usize][first].get_or_init(|| {
            let second = first + (1 << halves);
            geometry::intersection(self.common(halves, first), self.common(halves, second))
        })
    }

    /// Whether sections surely hold a region.
    fn hold(&self, range: Range<usize>, region: &Region) -> bool {
        let (Some(grid), Some(bounds)) = (self.grid, region.bounds()) else { return false };
        let mut layers = self.like[range].to_vec();
        layers.dedup();
        let within = |&i: &usize| self.within[i].get_or_init(|| Within::of(grid, &self.sections[i]));
        let sets: Vec<&Within> = layers.iter().map(within).collect();
        if !Within::all_hold_boundary(grid, &sets, region) {
            return false;
        }
        // Outlines that do not cross its boundary may be holes inside of it.
        let mut left = MOST_PASSED;
        let apart = |p| {
            let passed = if bounds.holds(p) { region.vertex_count() } else { 0 };
            left = left.saturating_sub(passed);
            left > 0 && (passed == 0 || !region.contains(p))
        };
        layers.iter().flat_map(|&i| self.sections[i].rings()).map(|ring| ring[0]).all(apart)
    }
}

/// The cells in which so many layers are looked at.
fn grid(bounds: Bounds, layers: usize) -> Grid {
    let [width, depth] = bounds.size().map(|units| units as f64 / geometry::UNITS_PER_MM);
    Grid::new(bounds, MARGIN_MM, CELL_MM.max((width * depth * layers as f64 / MOST_CELLS).sqrt()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::Mm;
    use geometry::{Point, Polygon, Ring};

    fn square(low_mm: f64, high_mm: f64) -> Ring {
        let corners = [(low_mm, low_mm), (high_mm, low_mm), (high_mm, high_mm), (low_mm, high_mm)];
        corners.map(|(x, y)| Point::from_mm(x, y)).to_vec()
    }

    #[test]
    fn a_region_is_held_unless_a_layer_ends_beside_it_or_has_a_hole_in_it() {
        let area = |outer: Ring, holes: Vec<Ring>| Region::from(Polygon { outer, holes });
        let hole: Ring = square(9.0, 11.0).into_iter().rev().collect();
        let (block, low) = (area(square(0.0, 20.0), Vec::new()), area(square(0.0, 17.0), Vec::new()));
        let (pierced, inside) = (area(square(0.0, 20.0), vec![hole]), area(square(2.0, 18.0), Vec::new()));
        let settings = ShellSettings { top_layers: 2, min_thickness: Mm(0.0), ..ShellSettings::default() };
        let map = |n: usize, f: &(dyn Fn(usize) -> Region + Sync)| (0..n).map(f).collect::<Vec<_>>();
        let held = |layers: [&Region; 3]| {
            let shells = Shells::build(&layers, &[0.2; 3], &settings, &map);
            shells.windows(0).top.is_some_and(|window| window.surely_holds(&inside))
        };
        assert!(held([&block, &block, &block]) && held([&pierced, &block, &block]));
        assert!(!held([&block, &block, &pierced]) && !held([&block, &low, &block]));
    }
}
