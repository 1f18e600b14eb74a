//! Medial axes of narrow regions, for gap fill and thin walls.

mod axis;
mod branches;
mod outline;

use axis::Node;
use branches::Trail;
use outline::{Outline, Position, direction, distance, lerp};

use super::{EdgeGrid, Point, Polygon, Region};

/// A line along the middle of a narrow region, with the region's width at each vertex.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MedialPath {
    /// Vertices, at least two (closed: at least three), no two neighbours equal.
    pub points: Vec<Point>,
    /// Width of the region at each vertex, in millimetres; linear in between.
    pub width_mm: Vec<f32>,
    /// Whether it returns from the last vertex to the first (which is not repeated).
    pub closed: bool,
}

impl MedialPath {
    /// Length in millimetres, the closing edge included.
    pub fn length_mm(&self) -> f64 {
        self.edges().map(|(a, b)| self.points[a].distance_mm(self.points[b])).sum()
    }

    /// Area that a bead of this width covers, without the round ends, in square millimetres.
    pub fn area_mm2(&self) -> f64 {
        let mean = |a: usize, b: usize| f64::from(self.width_mm[a] + self.width_mm[b]) / 2.0;
        self.edges().map(|(a, b)| self.points[a].distance_mm(self.points[b]) * mean(a, b)).sum()
    }

    fn edges(&self) -> impl Iterator<Item = (usize, usize)> {
        let n = self.points.len();
        let count = if self.closed { n } else { n.saturating_sub(1) };
        (0..count).map(move |i| (i, (i + 1) % n))
    }
}

/// Samples of the boundary are this many times the greatest width apart, at most.
const SPACING: f64 = 0.4;

/// Vertices are dropped that move the line, or the width, by no more than this: a hundredth of a common line width.
const TOLERANCE_MM: f64 = 0.005;

/// The middle lines of a region whose parts are about `min_mm` to `max_mm` wide.
///
/// Branches that lead into corners are pruned; at junctions the straightest branches are joined and the others
/// end there. Free ends reach to `tip` times the local width from the boundary: with ½, a bead with round ends just
/// touches it; with less, the bead fills the corners beside its end better and overlaps what is beyond. Parts narrower
/// than `min_mm` are left out; widths above `max_mm` are reported as `max_mm`. All points are inside the region. Paths
/// come polygon by polygon.
///
/// Chordal axis of the constrained Delaunay triangulation of the sampled boundary; O(n log n) for n samples. The line
/// is within about a tenth of the width of the exact medial axis, nearer where the sides are straight.
pub fn medial_axis(region: &Region, min_mm: f64, max_mm: f64, tip: f64) -> Vec<MedialPath> {
    if !(min_mm >= 0.0 && max_mm > 0.0 && max_mm >= min_mm && max_mm.is_finite()) {
        return Vec::new();
    }
    region.polygons.iter().flat_map(|polygon| of_polygon(polygon, min_mm, max_mm, tip)).collect()
}

fn of_polygon(polygon: &Polygon, min_mm: f64, max_mm: f64, tip: f64) -> Vec<MedialPath> {
    // A bound on the number of samples, where a huge region meets a tiny width.
    let length: f64 = polygon.rings().map(|ring| super::ring_length_mm(ring)).sum();
    let outline = Outline::sample(polygon, (SPACING * max_mm).max(length / 200_000.0).max(1e-3));
    let mut nodes = axis::chordal_axis(&outline);
    branches::prune(&mut nodes);
    let grid = EdgeGrid::new(&Region { polygons: vec![polygon.clone()] });
    branches::trails(&nodes)
        .into_iter()
        .map(|trail| Line::new(&nodes, &trail, &grid, max_mm, tip))
        .flat_map(|line| line.wide_parts(min_mm, max_mm))
        .filter_map(|line| line.into_path(&grid))
        .collect()
}

/// A path in the making.
struct Line {
    at: Vec<Position>,
    width: Vec<f64>,
    closed: bool,
}

impl Line {
    fn new(nodes: &[Node], trail: &Trail, grid: &EdgeGrid, max_mm: f64, tip: f64) -> Self {
        let (free, closed) = (trail.free, trail.closed);
        let mut trail = trail.nodes.as_slice();
        // A junction that lost its spurs says less about the middle than the nodes before it.
        let is_junction = |n: &u32| nodes[*n as usize].junction;
        if free[0] && trail.len() > 2 && trail.first().is_some_and(is_junction) {
            trail = &trail[1..];
        }
        if free[1] && trail.len() > 2 && trail.last().is_some_and(is_junction) {
            trail = &trail[..trail.len() - 1];
        }
        let on = trail.iter().map(|&n| &nodes[n as usize]);
        let mut line =
            Self { at: on.clone().map(|n| n.at).collect(), width: on.map(|n| n.width).collect(), closed };
        line.smooth();
        for end in [1, 0] {
            line.reverse();
            if free[1 - end] && !closed {
                line.extend(grid, max_mm, tip);
            }
        }
        line
    }

    fn reverse(&mut self) {
        self.at.reverse();
        self.width.reverse();
    }

    /// Takes the zig-zag out of the points: each to the middle between itself and its neighbours' middle.
    fn smooth(&mut self) {
        let n = self.at.len();
        if n < 3 {
            return;
        }
        let (at, width) = (self.at.clone(), self.width.clone());
        for i in 0..n {
            if !self.closed && (i == 0 || i + 1 == n) {
                continue;
            }
            let (a, b) = ((i + n - 1) % n, (i + 1) % n);
            // Weights by distance keep evenly curved lines where they are.
            let (da, db) = (distance(at[a], at[i]), distance(at[i], at[b]));
            let t = if da + db > 0.0 { da / (da + db) } else { 0.5 };
            self.at[i] = lerp(at[i], lerp(at[a], at[b], t), 0.5);
            self.width[i] = 0.5 * (width[i] + width[a] + t * (width[b] - width[a]));
        }
    }

    /// Moves the last end along the line to `tip` times the width from the boundary.
    fn extend(&mut self, grid: &EdgeGrid, max_mm: f64, tip: f64) {
        let Some(last) = self.at.len().checked_sub(1) else {
            return;
        };
        let (end, width) = (self.at[last], self.width[last]);
        let Some(back) =
            (0..last).rev().find(|&i| distance(self.at[i], end) >= width.min(0.5)).or(last.checked_sub(1))
        else {
            return;
        };
        let along = direction(self.at[back], end);
        let far = [end[0] + 4.0 * max_mm * along[0], end[1] + 4.0 * max_mm * along[1]];
        let Some(room) = first_hit(grid, end, far) else {
            return;
        };
        let by = room - tip * width;
        if by > 0.0 {
            self.at.push([end[0] + by * along[0], end[1] + by * along[1]]);
            self.width.push(width);
        } else {
            self.shorten(-by);
        }
    }

    /// Takes a length off the last end, up to the last edge.
    fn shorten(&mut self, mut by: f64) {
        while let [.., a, b] = self.at[..] {
            let length = distance(a, b);
            let last = self.at.len() - 1;
            if by < length {
                self.at[last] = lerp(b, a, by / length);
                self.width[last] += by / length * (self.width[last - 1] - self.width[last]);
                return;
            }
            if last == 1 {
                return;
            }
            by -= length;
            self.at.pop();
            self.width.pop();
        }
    }

    /// The parts at least `min_mm` wide, no width above `max_mm`.
    fn wide_parts(mut self, min_mm: f64, max_mm: f64) -> Vec<Line> {
        self.width.iter_mut().for_each(|w| *w = w.min(max_mm));
        let is_wide = |w: f64| w >= min_mm;
        if self.width.iter().all(|&w| is_wide(w)) {
            return vec![self];
        }
        if self.closed {
            // Opened at a narrow vertex.
            let cut = self.width.iter().position(|&w| !is_wide(w)).unwrap_or(0);
            self.at.rotate_left(cut);
            self.width.rotate_left(cut);
            self.at.push(self.at[0]);
            self.width.push(self.width[0]);
        }
        let mut parts = Vec::new();
        let mut part = Line { at: Vec::new(), width: Vec::new(), closed: false };
        for i in 0..self.at.len() {
            if i > 0 && is_wide(self.width[i]) != is_wide(self.width[i - 1]) {
                let t = (min_mm - self.width[i - 1]) / (self.width[i] - self.width[i - 1]);
                part.at.push(lerp(self.at[i - 1], self.at[i], t));
                part.width.push(min_mm);
            }
            if is_wide(self.width[i]) {
                part.at.push(self.at[i]);
                part.width.push(self.width[i]);
            } else if !part.at.is_empty() {
                let next = Line { at: Vec::new(), width: Vec::new(), closed: false };
                parts.push(std::mem::replace(&mut part, next));
            }
        }
        parts.push(part);
        parts
    }

    /// Leaves out vertices that change neither line nor width, and what rounding or smoothing put outside. `None` of what vanishes.
    fn into_path(self, grid: &EdgeGrid) -> Option<MedialPath> {
        let n = self.at.len();
        let mut kept: Vec<usize> = Vec::with_capacity(n);
        for i in 0..n {
            let straight = kept.last().is_some_and(|&a| {
                i + 1 < n && i - a < 24 && (a + 1..=i).all(|k| self.is_between(k, a, i + 1))
            });
            if !straight {
                kept.push(i);
            }
        }
        let mut path = MedialPath { closed: self.closed, ..Default::default() };
        for i in kept {
            let p = Point::from_mm(self.at[i][0], self.at[i][1]);
            if path.points.last() != Some(&p) && grid.contains(p) {
                path.points.push(p);
                path.width_mm.push(self.width[i] as f32);
            }
        }
        if path.closed && path.points.last() == path.points.first() {
            path.points.pop();
            path.width_mm.pop();
        }
        (path.points.len() >= if path.closed { 3 } else { 2 }).then_some(path)
    }

    /// Whether vertex `k` is where a straight edge from `a` to `b` passes, and as wide.
    fn is_between(&self, k: usize, a: usize, b: usize) -> bool {
        let (da, db) = (distance(self.at[a], self.at[k]), distance(self.at[k], self.at[b]));
        let t = if da + db > 0.0 { da / (da + db) } else { 0.5 };
        distance(self.at[k], lerp(self.at[a], self.at[b], t)) <= TOLERANCE_MM
            && (self.width[k] - self.width[a] - t * (self.width[b] - self.width[a])).abs() <= TOLERANCE_MM
    }
}

/// Distance from `a` to the first boundary edge on the way to `b`, in millimetres.
fn first_hit(grid: &EdgeGrid, a: Position, b: Position) -> Option<f64> {
    let (p, q) = (Point::from_mm(a[0], a[1]), Point::from_mm(b[0], b[1]));
    let mut near = Vec::new();
    grid.near_segment(p, q, &mut near);
    let hits = near.iter().filter_map(|&i| {
        let edge = &grid.edges()[i as usize];
        let (d, e) = (q - p, edge.b - edge.a);
        let turn = d.cross(e) as f64;
        let t = (edge.a - p).cross(e) as f64 / turn;
        let s = (edge.a - p).cross(d) as f64 / turn;
        ((0.0..=1.0).contains(&t) && (0.0..=1.0).contains(&s)).then_some(t * p.distance_mm(q))
    });
    hits.min_by(f64::total_cmp)
}
