//! Contact between layers.

use geometry::real;
use geometry::{Boxes, Point, Polygon, Region};

/// Whether two regions have an area in common.
pub(crate) fn meets(a: &Region, b: &Region) -> bool {
    let under = Under::new(b);
    a.polygons().iter().any(|polygon| under.carries(polygon))
}

/// What polygons may lie on.
pub(crate) struct Under<'a> {
    polygons: &'a [Polygon],
    boxes: Boxes,
}

impl<'a> Under<'a> {
    pub fn new(region: &'a Region) -> Self {
        Self { polygons: region.polygons(), boxes: Boxes::of(region) }
    }

    /// Whether a polygon has an area in common with it. Mostly a corner of one is inside the other.
    pub fn carries(&self, polygon: &Polygon) -> bool {
        let near = self.boxes.touching(&polygon.bounds());
        let near: Vec<&Polygon> = near.into_iter().map(|i| &self.polygons[i]).collect();
        let shares = |a: &Polygon, b: &Polygon| corners(a).any(|p| b.contains(p) && a.contains(p));
        let is_alike = |other: &Polygon| polygon.outer == other.outer;
        near.iter().any(|other| is_alike(other) || shares(polygon, other) || shares(other, polygon))
            || near.iter().any(|other| {
                let [a, b] = [polygon, other].map(|p| Region::from((*p).clone()));
                !geometry::intersection(&a, &b).is_empty()
            })
    }
}

/// How far within a polygon its corners are tried, millimetres.
const WITHIN_MM: f64 = 0.02;

/// Points just inside some convex corners.
fn corners(polygon: &Polygon) -> impl Iterator<Item = Point> + '_ {
    let outer = &polygon.outer;
    let count = outer.len();
    (0..count).step_by((count / 4).max(1)).map(move |i| {
        let (before, at, after) = (outer[(i + count - 1) % count], outer[i], outer[(i + 1) % count]);
        let towards = |p: Point| {
            let [dx, dy] = (p - at).mm();
            let length = real::hypot(dx, dy).max(f64::MIN_POSITIVE);
            [dx / length, dy / length]
        };
        let ([ax, ay], [bx, by]) = (towards(before), towards(after));
        at + Point::from_mm(WITHIN_MM * (ax + bx), WITHIN_MM * (ay + by))
    })
}
