//! Contact between layers.

use geometry::real;
use geometry::{Bounds, Point, Polygon, Region};

/// Whether two regions have an area in common.
pub(crate) fn meets(a: &Region, b: &Region) -> bool {
    a.polygons().iter().any(|polygon| lies_on(polygon, b))
}

/// Whether a polygon has an area in common with a region. Mostly a corner of one is inside the other.
pub(crate) fn lies_on(polygon: &Polygon, under: &Region) -> bool {
    let Some(bounds) = Bounds::of(polygon.outer.iter().copied()) else { return false };
    let near: Vec<&Polygon> = under
        .polygons()
        .iter()
        .filter(|other| Bounds::of(other.outer.iter().copied()).is_some_and(|b| b.touches(&bounds)))
        .collect();
    let shares = |a: &Polygon, b: &Polygon| corners(a).any(|p| b.contains(p) && a.contains(p));
    near.iter().any(|other| polygon.outer == other.outer || shares(polygon, other) || shares(other, polygon))
        || near.iter().any(|other| {
            let [a, b] = [polygon, other].map(|p| Region::from((*p).clone()));
            !geometry::intersection(&a, &b).is_empty()
        })
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
