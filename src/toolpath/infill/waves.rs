//! Curves side by side through a region, with their ends joined along the boundary: what bent patterns consist of.

use std::ops::RangeInclusive;

use geometry::real;
use geometry::{Clipper, Point, Region};

use super::super::bead::Line;
use super::connect::connect;
use super::spec::{Chord, FillSpec};

/// Parts lie within this of the origin, and differences of points within it fit the grid.
const FURTHEST_MM: f64 = 10_000.0;

/// A frame turned by the angle of the lines: `u` runs along them, `v` across.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    sin: f64,
    cos: f64,
}

impl Frame {
    /// A frame whose `u` runs in a direction.
    pub fn new(angle_rad: f64) -> Self {
        let (sin, cos) = real::sin_cos(angle_rad);
        Self { sin, cos }
    }

    /// A point of the plane from its position in the frame, in millimetres; as [`on_grid`].
    pub fn point(&self, [u, v]: [f64; 2]) -> Point {
        on_grid([u * self.cos - v * self.sin, u * self.sin + v * self.cos])
    }

    /// Least and greatest `u` and `v` of a region's vertices, in millimetres; `None` of an empty one.
    pub fn extent_mm(&self, region: &Region) -> Option<[[f64; 2]; 2]> {
        let points = region.polygons().iter().flat_map(|polygon| &polygon.outer).map(|p| {
            let [x, y] = p.mm();
            [x * self.cos + y * self.sin, y * self.cos - x * self.sin]
        });
        points.fold(None, |extent, at| {
            let [low, high] = extent.unwrap_or([at; 2]);
            Some([[0, 1].map(|i| low[i].min(at[i])), [0, 1].map(|i| high[i].max(at[i]))])
        })
    }
}

/// A point of the plane in millimetres, no further off than the grid can bear.
pub fn on_grid(at: [f64; 2]) -> Point {
    let [x, y] = at.map(|mm| mm.clamp(-FURTHEST_MM, FURTHEST_MM));
    Point::from_mm(x, y)
}

/// The whole multiples of a step that cover a range, and one more at either side.
pub fn steps(low_mm: f64, high_mm: f64, step_mm: f64) -> RangeInclusive<i64> {
    (low_mm / step_mm).floor() as i64 - 1..=(high_mm / step_mm).ceil() as i64 + 1
}

/// Lays curves into a region. Neighbours follow one another.
pub fn lay(region: &Region, curves: impl Iterator<Item = Vec<Point>>, spec: &FillSpec) -> Vec<Line> {
    let clipper = Clipper::new(region);
    let chords = (0..).zip(curves).flat_map(|(line, mut curve)| {
        curve.dedup();
        let pieces = clipper.clip(&curve);
        pieces.into_iter().map(move |piece| Chord { points: piece.points, ends: piece.ends, line })
    });
    connect(region, chords.collect(), &spec.joins)
}
