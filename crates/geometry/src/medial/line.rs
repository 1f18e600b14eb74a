//! A middle line while it becomes a path.

use super::axis::Node;
use super::branches::AxisPath;
use super::outline::{Position, direction, distance, lerp};
use super::path::MedialPath;
use crate::{EdgeGrid, Point};

/// Vertices are dropped that move the line by no more than this: a hundredth of a common line width.
const TOLERANCE_MM: f64 = 0.005;

/// The same of the width, by which a long line would hold less throughout.
const WIDTH_TOLERANCE_MM: f64 = 0.002;

/// A path in the making.
#[derive(Clone, Debug)]
pub(super) struct Line {
    pub(super) at: Vec<Position>,
    pub(super) width: Vec<f64>,
    pub(super) closed: bool,
}

impl Line {
    pub(super) fn new(nodes: &[Node], path: &AxisPath, grid: &EdgeGrid, max_mm: f64, tip: f64) -> Self {
        let (free, closed) = (path.free, path.closed);
        let mut path = path.nodes.as_slice();
        // A junction that lost its spurs says less about the middle than the nodes before it.
        let is_junction = |n: &u32| nodes[*n as usize].junction;
        if free[0] && path.len() > 2 && path.first().is_some_and(is_junction) {
            path = &path[1..];
        }
        if free[1] && path.len() > 2 && path.last().is_some_and(is_junction) {
            path = &path[..path.len() - 1];
        }
        let on = path.iter().map(|&n| &nodes[n as usize]);
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
        let Some(free_mm) = first_hit(grid, end, far) else {
            return;
        };
        let by = free_mm - tip * width;
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

    /// Opens a closed line at a vertex, which becomes both ends.
    pub(super) fn open_at(&mut self, vertex: usize) {
        self.at.rotate_left(vertex);
        self.width.rotate_left(vertex);
        self.at.push(self.at[0]);
        self.width.push(self.width[0]);
        self.closed = false;
    }

    /// The parts at least `min_mm` wide, no width above `max_mm`.
    pub(super) fn wide_parts(mut self, min_mm: f64, max_mm: f64) -> Vec<Line> {
        self.width.iter_mut().for_each(|w| *w = w.min(max_mm));
        let is_wide = |w: f64| w >= min_mm;
        if self.width.iter().all(|&w| is_wide(w)) {
            return vec![self];
        }
        if self.closed {
            // Opened at a narrow vertex.
            let cut = self.width.iter().position(|&w| !is_wide(w)).unwrap_or(0);
            self.open_at(cut);
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
    pub(super) fn into_path(self, grid: &EdgeGrid) -> Option<MedialPath> {
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
            let p = point(self.at[i]);
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
            && (self.width[k] - self.width[a] - t * (self.width[b] - self.width[a])).abs()
                <= WIDTH_TOLERANCE_MM
    }
}

pub(super) fn point([x, y]: Position) -> Point {
    Point::from_mm(x, y)
}

/// Distance from `a` to the first boundary edge on the path to `b`, in millimetres.
fn first_hit(grid: &EdgeGrid, a: Position, b: Position) -> Option<f64> {
    hits(grid, a, b).min_by(f64::total_cmp).map(|t| t * distance(a, b))
}

/// Where a segment meets the boundary, as shares of its length, in no order and some several times.
pub(super) fn hits(grid: &EdgeGrid, a: Position, b: Position) -> impl Iterator<Item = f64> {
    let (p, q) = (point(a), point(b));
    grid.edges_along(p, q).filter_map(move |edge| {
        let (d, e) = (q - p, edge.b - edge.a);
        let turn = d.cross(e) as f64;
        let t = (edge.a - p).cross(e) as f64 / turn;
        let s = (edge.a - p).cross(d) as f64 / turn;
        ((0.0..=1.0).contains(&t) && (0.0..=1.0).contains(&s)).then_some(t)
    })
}
