//! Medial axes of narrow regions, for gap fill and thin walls.

mod axis;
mod branches;
mod line;
mod outline;
mod path;
mod whole;

pub use path::MedialPath;

use axis::Node;
use line::{Line, point};
use outline::Outline;
use whole::WholeLines;

use super::{Boxes, EdgeGrid, Known, Polygon, Region, Shape};

/// Samples of the boundary are this many times the greatest width apart, at most, beside its corners.
const SPACING: f64 = 0.4;

/// Lines that cover less than this share of a part do not fit it.
const ENOUGH: f64 = 0.5;

/// How far around an area its region is looked at, as a multiple of the greatest width.
const REACH: f64 = 0.6;

/// Points of middle lines that are kept, and as many again of those used before them.
const KEPT: usize = 100_000;

/// Middle lines that were found before: neighbouring layers have many narrow parts in common.
#[derive(Clone, Debug)]
pub struct KnownAxes(Known<WholeLines>);

impl Default for KnownAxes {
    fn default() -> Self {
        Self(Known::new(KEPT))
    }
}

/// The middle lines of a region whose parts are about `min_mm` to `max_mm` wide.
///
/// Branches that lead into corners are pruned; at a junction the two straightest branches are one line, and the others
/// end beside it. Free ends reach to `tip` times the local width from the boundary: with ½, a bead with round ends just
/// touches it; with less, the bead fills the corners beside its end better and overlaps what is beyond. Parts narrower
/// than `min_mm` are left out; widths above `max_mm` are reported as `max_mm`. All points are inside the region. Paths
/// come polygon by polygon.
///
/// Chordal axis of the constrained Delaunay triangulation of the sampled boundary; O(n log n) for n samples. The line
/// is within about a tenth of the width of the exact medial axis, nearer where the sides are straight.
pub fn medial_axis(region: &Region, min_mm: f64, max_mm: f64, tip: f64) -> Vec<MedialPath> {
    if !are_widths(min_mm, max_mm) {
        return Vec::new();
    }
    region.polygons.iter().flat_map(|polygon| of_polygon(polygon, min_mm, max_mm, tip)).collect()
}

/// As [`medial_axis`], for the parts of a region inside `area`, such as its narrow parts.
///
/// The lines are cut out of those of the region. So a neck has its line along it, however short it is, where the neck alone
/// might be wider than long. They end where they leave the area; lines shorter than 0.2 mm reach out of it instead. Where all
/// this covers less than half of a part, as at flat ends, it gets its own middle lines, if they cover more. Points may be
/// outside of the region by a grid unit, as what is looked at around the area is cut out of it.
pub fn medial_axis_in(
    area: &Region,
    region: &Region,
    min_mm: f64,
    max_mm: f64,
    tip: f64,
    known: &KnownAxes,
) -> Vec<MedialPath> {
    if !are_widths(min_mm, max_mm) {
        return Vec::new();
    }
    let around = super::intersection(region, &super::offset(area, REACH * max_mm));
    let all = EdgeGrid::new(area);
    let parts = Boxes::of(area);
    // A spur that comes from elsewhere is not covered by a line there.
    let covers = |node: &Node| all.contains(point(node.at));
    let lines_in = |polygon: &Polygon| {
        let grid = EdgeGrid::of(polygon);
        let make = || WholeLines::new(lines(polygon, &grid, covers, max_mm, tip).into_iter());
        let bounds = grid.bounds().grown(1);
        let near = parts.touching(&bounds).into_iter().map(|part| &area.polygons[part]);
        let shape = Shape::new(std::iter::once(polygon).chain(near), [max_mm.to_bits(), tip.to_bits()]);
        (known.0.of(shape, WholeLines::len, make), grid)
    };
    let wholes: Vec<_> = around.polygons.iter().map(lines_in).collect();
    let boxes = Boxes::new(wholes.iter().map(|(_, grid)| grid.bounds()));
    let in_part = |part: &Polygon| {
        let inside = EdgeGrid::of(part);
        let mut cuts = Vec::new();
        for whole in boxes.touching(&inside.bounds().grown(1)) {
            let (lines, grid) = &wholes[whole];
            cuts.extend(paths(lines.parts_in(&inside), grid, min_mm, max_mm));
        }
        if covered_mm2(&cuts) < ENOUGH * part.area_mm2() {
            let own = of_polygon(part, min_mm, max_mm, tip);
            if covered_mm2(&own) > covered_mm2(&cuts) {
                return own;
            }
        }
        cuts
    };
    area.polygons.iter().flat_map(in_part).collect()
}

fn covered_mm2(paths: &[MedialPath]) -> f64 {
    paths.iter().map(MedialPath::area_mm2).sum()
}

fn are_widths(min_mm: f64, max_mm: f64) -> bool {
    min_mm >= 0.0 && max_mm > 0.0 && max_mm >= min_mm && max_mm.is_finite()
}

fn of_polygon(polygon: &Polygon, min_mm: f64, max_mm: f64, tip: f64) -> Vec<MedialPath> {
    let grid = EdgeGrid::of(polygon);
    let lines = lines(polygon, &grid, |_| true, max_mm, tip).into_iter();
    paths(lines, &grid, min_mm, max_mm).collect()
}

/// The middle lines of a polygon; spurs of the junctions that `covers` names are pruned.
fn lines(
    polygon: &Polygon,
    grid: &EdgeGrid,
    covers: impl Fn(&Node) -> bool,
    max_mm: f64,
    tip: f64,
) -> Vec<Line> {
    // A bound on the number of samples, where a huge region meets a tiny width.
    let length: f64 = polygon.rings().map(|ring| super::ring_length_mm(ring)).sum();
    let outline = Outline::sample(polygon, (SPACING * max_mm).max(length / 200_000.0).max(1e-3));
    let mut nodes = axis::chordal_axis(&outline);
    let branches = branches::prune(&mut nodes, covers);
    let paths = branches::axis_paths(&nodes, branches);
    paths.into_iter().map(|path| Line::new(&nodes, &path, grid, max_mm, tip)).collect()
}

/// The parts of lines that are wide enough, within a boundary.
fn paths(
    lines: impl Iterator<Item = Line>,
    grid: &EdgeGrid,
    min_mm: f64,
    max_mm: f64,
) -> impl Iterator<Item = MedialPath> {
    lines.flat_map(move |line| line.wide_parts(min_mm, max_mm)).filter_map(|line| line.into_path(grid))
}
