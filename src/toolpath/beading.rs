//! Pairs of beads along the boundary whose width follows the thickness of the part.
//!
//! After Kuipers, Doubrovski, Wu, Wang: "A framework for adaptive width control of dense contour-parallel toolpaths in
//! fused deposition modeling", Computer-Aided Design 128 (2020), DOI 10.1016/j.cad.2020.102907: where a part is not a
//! whole number of beads thick, the beads in its middle are made wider or narrower, the others keep their width. With
//! s the spacing of a bead and t what is left of the thickness, a point gets
//!
//! - one bead of width t, where t < 1.5 s;
//! - two beads of t/2, where 1.5 s ≤ t < 2.5 s;
//! - two beads of s, and the rest again by this table, where t ≥ 2.5 s.
//!
//! So a middle bead is between half and one and a half times as wide as requested, one of a pair at least three
//! quarters and at most five quarters; one of the innermost pair of several walls, which has no middle bead up to
//! t = 3 s, at most one and a half times. Instead of a skeletal trapezoidation, the positions are found by offsets, and the
//! thickness is that of the largest disc that touches the boundary and its opposite side (Ma, Bae, Choi: "3D medial
//! axis point approximation using nearest neighbors and the normal field", The Visual Computer 28 (2012),
//! DOI 10.1007/s00371-011-0594-7, with edges instead of points).

use std::cell::OnceCell;
use std::f64::consts::TAU;

use geometry::real;
use geometry::{Bounds, Core, EdgeGrid, Join, Point, Polygon, Region, Ring, UNITS_PER_MM, distance_mm};

use super::bead::Line;
use super::unfold::{Vertex, unfold};

/// Half the thickness at which a part gets two beads instead of one, in spacings.
pub(super) const PAIR: f64 = 0.75;

/// Parts that are thicker than where pairs, or infill, begin by less than this on average, in spacings, get single beads
/// throughout: else tiny loops and short beads would alternate where the thickness goes to and fro about that.
const HYSTERESIS: f64 = 0.08;

/// Half the thickness at which the beads of a pair have their own width and a bead fits between them, in spacings.
pub(super) const FULL: f64 = 1.25;

/// The same for the innermost pair of walls: instead of a thin bead between them they get up to half as wide again.
pub(super) const FULL_INNERMOST: f64 = 1.5;

/// Corners sharper than 60° are left to single beads, which reach further into them; of inner walls only those sharper than 39°:
/// a dot in each would take longer than it fills.
pub(super) const INNER_CORNERS: Join = Join::Miter { limit: 3.0 };

/// Gaps narrower than this hold no bead that a nozzle could lay.
pub(super) const MIN_GAP_MM: f64 = 0.12;

/// Beads in gaps end this share of their width before the gap does: round ends would leave its corners open. Where other lines
/// go on, they end with the gap.
pub(super) const GAP_TIP: f64 = 0.25;

/// The widest single bead, in spacings: at junctions a little more than the module says.
pub(super) const WIDEST: f64 = 1.6;

/// Sides face each other whose normals enclose at most an angle with this cosine: 135°.
const FACING: f64 = -0.7;

/// Corners whose squared sine is less are none, or needles.
const NEARLY_STRAIGHT: f64 = 0.05;

/// A bead passes the tip of a wedge in its boundary at most this many times as far as its sides.
const BEYOND_WEDGE: f64 = 2.0;

/// The thickness is looked up at least this often, in spacings.
const STEP: f64 = 0.6;

/// Where half the thickness is more than [`FULL`] by less than this, in spacings, there may be no room for beads between.
const SLIGHT: f64 = 0.01;

/// What is narrower by less, in millimetres, is as wide.
const NARROWER_MM: f64 = 0.002;

/// Corners of a dot's loop.
const DOT_CORNERS: u32 = 6;

/// Its radius and the width of its bead, as shares of the largest disc's diameter: together they reach to the disc's edge,
/// and the bead holds seven tenths of the square around it.
const DOT_RADIUS: f64 = 1.0 / 6.0;
const DOT_WIDTH: f64 = 0.7;

/// How exactly the largest disc is found.
const DEPTH_MM: f64 = 0.005;

/// A narrow area, to be filled with single beads.
#[derive(Clone, Debug, PartialEq)]
pub struct Gap {
    /// The area to fill.
    pub area: Region,
    /// The region in which it is narrow: other lines lie on the rest.
    pub region: Region,
}

/// The outermost beads of a region, and what they leave.
pub(super) struct Pair {
    /// Closed beads along the boundary.
    pub(super) loops: Vec<Line>,
    /// Where there is room for a single bead.
    pub(super) gap: Option<Gap>,
    /// What lies inside the loops.
    pub(super) rest: Region,
}

/// Lays one bead along the boundary of a region, with widths as the module says. Gaps narrower than `least_mm` are none.
pub(super) fn pair(region: &Region, spacing_mm: f64, full: f64, least_mm: f64, corners: Join) -> Pair {
    let core = core(region, PAIR * spacing_mm, spacing_mm, corners);
    let covered = core.grown(PAIR * spacing_mm);
    let gap = gap(region, &core, PAIR * spacing_mm, least_mm);
    let deep = geometry::core(&core.region, (full - PAIR) * spacing_mm);
    let rest = geometry::offset(&deep.region, (full - 1.0) * spacing_mm);
    let loops = if geometry::narrower(&covered, &deep, full * spacing_mm, MIN_GAP_MM).is_empty() {
        constant(&core.grown((PAIR - 0.5) * spacing_mm))
    } else {
        let centre = core.grown(PAIR / 2.0 * spacing_mm);
        let [grid, outline] = [&covered, region].map(EdgeGrid::new);
        let sides = Sides { grid, outline, spacing_mm, full, rest: &rest, rest_grid: OnceCell::new() };
        centre.rings().filter_map(|ring| sides.fit(ring)).collect()
    };
    Pair { loops, gap, rest }
}

/// A region shrunk by a radius, without parts that are only occasionally thicker than that.
pub(super) fn core(region: &Region, radius_mm: f64, spacing_mm: f64, corners: Join) -> Core {
    let mut core = Core { corners, ..geometry::core(region, radius_mm) };
    let count = core.region.polygons().len();
    core.region.retain(|polygon| {
        let around_mm: f64 = polygon.rings().map(|ring| geometry::ring_length_mm(ring)).sum();
        // What is no longer than wide is the middle of a post, which takes no bead along its axis.
        around_mm < spacing_mm || 2.0 * polygon.area_mm2() >= HYSTERESIS * spacing_mm * around_mm
    });
    core.is_whole &= core.region.polygons().len() == count;
    core
}

/// Fills a region with nested beads until nothing is left: loops, and the areas for single beads.
pub(super) fn fill(region: &Region, spacing_mm: f64) -> (Vec<Line>, Vec<Gap>) {
    let (mut loops, mut gaps) = (Vec::new(), Vec::new());
    let mut rest = region.clone();
    while !rest.is_empty() {
        let pair = pair(&rest, spacing_mm, FULL, MIN_GAP_MM, Join::DEFAULT);
        loops.extend(pair.loops);
        gaps.extend(pair.gap);
        rest = pair.rest;
    }
    (loops, gaps)
}

/// The bead of an island too small for a line: a loop about its deepest point, as wide as one bead, and that bead's
/// width. The island is at least `least_mm` across.
pub(super) fn dot(island: &Polygon, least_mm: f64) -> Option<(Ring, f64)> {
    let island = Region::from(island.clone());
    let bounds = island.bounds()?;
    // The largest disc inside is as large as what the island can be shrunk by.
    let (mut from_mm, mut to_mm) = (0.0, bounds.min.distance_mm(bounds.max));
    let mut deepest = bounds;
    while to_mm - from_mm > DEPTH_MM {
        let radius_mm = (from_mm + to_mm) / 2.0;
        match geometry::offset(&island, -radius_mm).polygons().first().map(Polygon::bounds) {
            Some(core) => (from_mm, deepest) = (radius_mm, core),
            None => to_mm = radius_mm,
        }
    }
    let across_mm = 2.0 * from_mm;
    let ([x0, y0], [x1, y1]) = (deepest.min.mm(), deepest.max.mm());
    let corner = |k: u32| {
        let (sin, cos) = real::sin_cos(f64::from(k) * TAU / f64::from(DOT_CORNERS));
        let radius_mm = DOT_RADIUS * across_mm;
        Point::from_mm((x0 + x1) / 2.0 + radius_mm * cos, (y0 + y1) / 2.0 + radius_mm * sin)
    };
    (across_mm >= least_mm).then(|| ((0..DOT_CORNERS).map(corner).collect(), DOT_WIDTH * across_mm))
}

/// Loops of the requested width.
pub(super) fn constant(centre: &Region) -> Vec<Line> {
    centre.rings().filter_map(|ring| Line::nominal(ring.clone(), true).sound()).collect()
}

/// The areas where a region is narrower than twice the radius that it was shrunk by to `core`, and at least `least_mm`.
pub(super) fn gap(region: &Region, core: &Core, radius_mm: f64, least_mm: f64) -> Option<Gap> {
    let area = geometry::narrower(region, core, radius_mm, least_mm);
    (!area.is_empty()).then(|| Gap { area, region: region.clone() })
}

/// A sample along a bead: position, direction inwards, spacing.
struct Sample {
    at: [f64; 2],
    inwards: [f64; 2],
    spacing_mm: f64,
}

/// Edges that face another, and what they are found with.
#[derive(Default)]
struct Facing {
    found: Vec<u32>,
    edges: Vec<[[f64; 2]; 2]>,
}

/// The boundary that beads are laid along.
struct Sides<'a> {
    /// Of the part that gets pairs.
    grid: EdgeGrid,
    /// Of the whole region, which no bead may leave.
    outline: EdgeGrid,
    spacing_mm: f64,
    /// Half the thickness at which beads have their own width, in spacings.
    full: f64,
    /// What is left inside of these.
    rest: &'a Region,
    rest_grid: OnceCell<EdgeGrid>,
}

impl Sides<'_> {
    /// The bead along a ring that lies half the narrowest bead inside the boundary, moved inwards where it is wider.
    fn fit(&self, ring: &Ring) -> Option<Line> {
        let n = ring.len();
        let corners: Vec<[f64; 2]> = ring.iter().map(|p| p.mm()).collect();
        let mut near = Facing::default();
        let mut samples = Vec::with_capacity(3 * n);
        let starts: Vec<usize> = (0..n)
            .map(|i| {
                let start = samples.len();
                self.along(corners[i], corners[(i + 1) % n], &mut near, &mut samples);
                start
            })
            .collect();
        let edge = |i: usize| &samples[starts[i]..starts.get(i + 1).copied().unwrap_or(samples.len())];
        let mut bead = Vec::with_capacity(samples.len());
        for i in 0..n {
            let (edge, before) = (edge(i), edge((i + n - 1) % n));
            let (Some(start), Some(end)) = (edge.first(), before.last()) else {
                continue;
            };
            let corner = self.corner(end, start);
            self.widen(before.iter().rev(), before.len(), corner.spacing_mm, &mut bead);
            push(corner, &mut bead);
            self.widen(edge.iter(), edge.len(), corner.spacing_mm, &mut bead);
            for sample in edge.get(1..edge.len() - 1).unwrap_or_default() {
                push(self.beside(sample), &mut bead);
            }
        }
        let bead = unfold(&bead);
        let mut line = Line::nominal(bead.iter().map(|vertex| vertex.at).collect(), true);
        line.spacing_mm.extend(bead.iter().map(|vertex| vertex.spacing_mm as f32));
        if line.spacing_mm.iter().all(|&s| s == self.spacing_mm as f32) {
            line.spacing_mm.clear();
        }
        line.sound()
    }

    /// How far a bead lies inside the ring.
    fn shift_mm(&self, sample: &Sample) -> f64 {
        (sample.spacing_mm - PAIR * self.spacing_mm) / 2.0
    }

    /// The vertex between two edges, inside either by half its bead, and as wide as the narrower one: a wider bead
    /// would protrude beside that.
    fn corner(&self, end: &Sample, start: &Sample) -> Vertex {
        let (a, b) = (end.inwards, start.inwards);
        let cosine = a[0] * b[0] + a[1] * b[1];
        let (from, to) = (self.shift_mm(end), self.shift_mm(start));
        let square = 1.0 - cosine * cosine;
        let by = if square > NEARLY_STRAIGHT {
            let (along_a, along_b) = ((from - to * cosine) / square, (to - from * cosine) / square);
            let by = [0, 1].map(|k| along_a * a[k] + along_b * b[k]);
            // About the tip of a wedge the bead turns near by, which may be narrow there.
            let furthest_mm = BEYOND_WEDGE * from.max(to);
            let is_wedge = a[0] * b[1] < a[1] * b[0];
            let share = if is_wedge { (furthest_mm / real::hypot(by[0], by[1])).min(1.0) } else { 1.0 };
            by.map(|by| share * by)
        } else {
            [0, 1].map(|k| (from * a[k] + to * b[k]) / 2.0)
        };
        let spacing_mm = start.spacing_mm.min(end.spacing_mm);
        self.vertex(start, by, spacing_mm)
    }

    /// Where an edge that has no samples between its ends is wider than the bead at one of them, its bead is as wide near by,
    /// not at the other end only.
    fn widen<'s>(
        &self,
        mut ends: impl Iterator<Item = &'s Sample>,
        count: usize,
        spacing_mm: f64,
        bead: &mut Vec<Vertex>,
    ) {
        let (Some(here), Some(there)) = (ends.next(), ends.next()) else { return };
        if count > 2 || spacing_mm > here.spacing_mm - NARROWER_MM {
            return;
        }
        let share = STEP * self.spacing_mm / distance_mm(here.at, there.at);
        if share < 0.5 {
            let at = [0, 1].map(|i| here.at[i] + share * (there.at[i] - here.at[i]));
            push(self.beside(&Sample { at, ..*here }), bead);
        }
    }

    /// The vertex beside a sample of an edge.
    fn beside(&self, sample: &Sample) -> Vertex {
        let by = sample.inwards.map(|k| k * self.shift_mm(sample));
        self.vertex(sample, by, sample.spacing_mm)
    }

    /// Distance to the outline, as far as it is less than half a spacing.
    fn clearance_mm(&self, at: Point, spacing_mm: f64) -> f64 {
        self.outline.distance_mm(at, spacing_mm / 2.0).min(spacing_mm / 2.0)
    }

    /// A vertex, moved from a sample, no wider than the clearance there.
    fn vertex(&self, sample: &Sample, by: [f64; 2], spacing_mm: f64) -> Vertex {
        let Sample { at: [x, y], inwards, .. } = *sample;
        let at = Point::from_mm(x + by[0], y + by[1]);
        let spacing_mm = spacing_mm.min(2.0 * self.clearance_mm(at, spacing_mm));
        Vertex { at, spacing_mm, ahead: [inwards[1], -inwards[0]] }
    }

    /// Appends both ends of an edge, and samples between where the other side is near.
    fn along(&self, a: [f64; 2], b: [f64; 2], near: &mut Facing, samples: &mut Vec<Sample>) {
        let length_mm = real::hypot(b[0] - a[0], b[1] - a[1]);
        if length_mm <= 0.0 {
            return;
        }
        let inwards = [(a[1] - b[1]) / length_mm, (b[0] - a[0]) / length_mm];
        let facing = self.facing(a, b, inwards, near);
        let steps =
            if facing.is_empty() { 1.0 } else { (length_mm / (STEP * self.spacing_mm)).ceil().max(3.0) };
        let sample = |k: usize| {
            let at = [0, 1].map(|i| a[i] + (b[i] - a[i]) * k as f64 / steps);
            Sample { at, inwards, spacing_mm: self.spacing_at(at, inwards, facing) }
        };
        let (first, last) = (samples.len(), steps as usize);
        for k in 0..=last {
            let sample = sample(k);
            // Of samples of one width those between others go. Those next to the corners stay: the corner's width is between those of
            // both edges.
            if let [.., before, here] = &samples[first..]
                && samples.len() - first > 2
                && k < last
                && before.spacing_mm == here.spacing_mm
                && here.spacing_mm == sample.spacing_mm
            {
                samples.pop();
            }
            samples.push(sample);
        }
    }

    /// Edges of the boundary that face an edge of the ring near enough to matter, as their ends.
    fn facing<'n>(
        &self,
        a: [f64; 2],
        b: [f64; 2],
        inwards: [f64; 2],
        near: &'n mut Facing,
    ) -> &'n [[[f64; 2]; 2]] {
        let reach = 2.0 * self.full * self.spacing_mm * UNITS_PER_MM;
        let [p, q] = [a, b].map(|v| Point::from_mm(v[0], v[1]));
        self.grid.near_box(Bounds::spanned(p, q).grown(reach as i32), &mut near.found);
        let edges = near.found.iter().map(|&i| &self.grid.edges()[i as usize]);
        near.edges.clear();
        near.edges.extend(edges.map(|edge| [edge.a.mm(), edge.b.mm()]).filter(|[c, d]| {
            let length_mm = real::hypot(d[0] - c[0], d[1] - c[1]);
            let cosine = (inwards[0] * (c[1] - d[1]) + inwards[1] * (d[0] - c[0])) / length_mm;
            cosine <= FACING
        }));
        &near.edges
    }

    /// The bead's spacing at a point of the ring.
    fn spacing_at(&self, at: [f64; 2], inwards: [f64; 2], facing: &[[[f64; 2]; 2]]) -> f64 {
        let foot = [0, 1].map(|k| at[k] - inwards[k] * PAIR / 2.0 * self.spacing_mm);
        let radius_mm =
            facing.iter().map(|&side| touching(foot, inwards, side)).fold(f64::INFINITY, f64::min);
        let over = radius_mm / self.spacing_mm - self.full;
        let middle = || [0, 1].map(|k| foot[k] + inwards[k] * radius_mm);
        if over >= SLIGHT || over >= 0.0 && self.leaves_room(middle()) {
            self.spacing_mm
        } else {
            radius_mm.max(PAIR * self.spacing_mm)
        }
    }

    /// Whether beads follow between those of this pair. Where there is next to no room for them, it got lost.
    fn leaves_room(&self, [x, y]: [f64; 2]) -> bool {
        let grid = self.rest_grid.get_or_init(|| EdgeGrid::new(self.rest));
        grid.contains(Point::from_mm(x, y))
    }
}

/// Appends a vertex. Of several in the same place the first stays, with the direction of the last.
fn push(vertex: Vertex, bead: &mut Vec<Vertex>) {
    match bead.last_mut() {
        Some(last) if last.at == vertex.at => last.ahead = vertex.ahead,
        _ => bead.push(vertex),
    }
}

/// Radius of the disc that touches the boundary at `foot`, where `inwards` is the normal, and an edge.
fn touching(foot: [f64; 2], inwards: [f64; 2], [a, b]: [[f64; 2]; 2]) -> f64 {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let length_mm = real::hypot(dx, dy);
    let normal = [-dy / length_mm, dx / length_mm];
    let distance_mm = normal[0] * (foot[0] - a[0]) + normal[1] * (foot[1] - a[1]);
    let radius_mm = distance_mm / (1.0 - normal[0] * inwards[0] - normal[1] * inwards[1]);
    let touch = [0, 1].map(|k| foot[k] + radius_mm * (inwards[k] - normal[k]));
    let along = ((touch[0] - a[0]) * dx + (touch[1] - a[1]) * dy) / (length_mm * length_mm);
    if (0.0..=1.0).contains(&along) {
        return if radius_mm > 0.0 { radius_mm } else { f64::INFINITY };
    }
    [a, b]
        .map(|end| {
            let to = [end[0] - foot[0], end[1] - foot[1]];
            let depth_mm = to[0] * inwards[0] + to[1] * inwards[1];
            if depth_mm > 0.0 { (to[0] * to[0] + to[1] * to[1]) / (2.0 * depth_mm) } else { f64::INFINITY }
        })
        .into_iter()
        .fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_corner_that_is_narrower_does_not_make_its_sides_narrower() {
        // A plate with a corner that is rounder than its bead, and a rib in which widths have to fit.
        const RADIUS_MM: f64 = 0.28;
        let arc = (0..=8u32).map(|k| {
            let (sine, cosine) = real::sin_cos(f64::from(k) * TAU / 32.0);
            Point::from_mm(20.0 + RADIUS_MM * (cosine - 1.0), 10.0 + RADIUS_MM * (sine - 1.0))
        });
        let straight =
            [(0.0, 10.0), (0.0, 0.0), (9.5, 0.0), (9.5, -4.0), (10.5, -4.0), (10.5, 0.0), (20.0, 0.0)];
        let outer = arc.chain(straight.map(|(x, y)| Point::from_mm(x, y))).collect();
        let region = Region::from(Polygon { outer, holes: Vec::new() });
        let lines = pair(&region, 0.4, FULL, MIN_GAP_MM, Join::DEFAULT).loops;
        let widths =
            |line: &Line| line.points.iter().map(|p| p.mm()).zip(line.spacing_mm.clone()).collect::<Vec<_>>();
        let top: Vec<([f64; 2], f32)> =
            lines.iter().flat_map(widths).filter(|([_, y], _)| *y > 9.6).collect();
        assert!(top.iter().any(|(_, spacing_mm)| *spacing_mm < 0.38), "the corner is narrower: {top:?}");
        let is_wide =
            |([x, _], spacing_mm): &([f64; 2], f32)| (19.0..19.7).contains(x) && *spacing_mm > 0.395;
        assert!(top.iter().any(is_wide), "its side is as wide as ever near by: {top:?}");
    }
}
