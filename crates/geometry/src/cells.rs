//! The plane divided by what is nearest: Voronoi cells of points (Aurenhammer 1991, <https://doi.org/10.1145/116873.116880>),
//! those of one kind united.

use std::collections::BTreeMap;

use spade::{DelaunayTriangulation, HasPosition, Point2, Triangulation};

use super::boolean::unite_rings;
use super::{Bounds, Point, Region, Ring};

/// A point with its kind; `None`: of the frame around all.
struct Site {
    at: Point,
    kind: Option<u8>,
}

impl HasPosition for Site {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        Point2::new(f64::from(self.at.x), f64::from(self.at.y))
    }
}

/// For each kind, ascending, the region to whose places the nearest of some points is of that kind. It ends somewhere around the
/// points, at least as far from them as they are from each other. Of points at one place the last counts. O(n log n).
///
/// # Examples
/// ```
/// use pathwright_geometry::{Point, nearest_kinds};
///
/// let regions = nearest_kinds(&[(Point::from_mm(0.0, 0.0), 1), (Point::from_mm(2.0, 0.0), 2)]);
/// assert_eq!(regions.iter().map(|(kind, _)| *kind).collect::<Vec<_>>(), [1, 2]);
/// assert!(regions[0].1.contains(Point::from_mm(0.9, 1.0)) && !regions[0].1.contains(Point::from_mm(1.1, 1.0)));
/// ```
pub fn nearest_kinds(points: &[(Point, u8)]) -> Vec<(u8, Region)> {
    let Some(bounds) = Bounds::of(points.iter().map(|(point, _)| *point)) else { return Vec::new() };
    let mut sites: Vec<Site> = points.iter().map(|&(at, kind)| Site { at, kind: Some(kind) }).collect();
    sites.extend(frame(bounds).map(|at| Site { at, kind: None }));
    let Ok(triangulation) = DelaunayTriangulation::<Site>::bulk_load_stable(sites) else { return Vec::new() };
    // The middle of each triangle's circle is a corner of cells.
    let count = triangulation.num_all_faces();
    let mut corners = vec![Point::default(); count];
    let mut next: BTreeMap<u8, Vec<u32>> = BTreeMap::new();
    for face in triangulation.inner_faces() {
        let middle = face.circumcenter();
        corners[face.fix().index()] = Point::new(middle.x.round() as i32, middle.y.round() as i32);
        for edge in face.adjacent_edges() {
            let [from, to] = [edge.from().data().kind, edge.to().data().kind];
            // With the cell of `to` on the left, its border leads out of the triangle.
            if let Some(kind) = to.filter(|_| from != to)
                && let Some(beyond) = edge.rev().face().as_inner()
            {
                let next = next.entry(kind).or_insert_with(|| vec![NONE; count]);
                next[face.fix().index()] = beyond.fix().index() as u32;
            }
        }
    }
    next.into_iter().map(|(kind, next)| (kind, unite_rings(&borders(next, &corners)))).collect()
}

const NONE: u32 = u32::MAX;

/// The closed lines in which corners follow each other.
fn borders(mut next: Vec<u32>, corners: &[Point]) -> Vec<Ring> {
    let mut rings = Vec::new();
    for first in 0..next.len() {
        let (mut ring, mut at) = (Ring::new(), first);
        while next[at] != NONE {
            if ring.last() != Some(&corners[at]) {
                ring.push(corners[at]);
            }
            at = std::mem::replace(&mut next[at], NONE) as usize;
        }
        if ring.len() >= 3 {
            rings.push(ring);
        }
    }
    rings
}

/// Points around a box, farther away than it is long.
fn frame(bounds: Bounds) -> impl Iterator<Item = Point> {
    let [width, height] = bounds.size();
    let out = (2 * width.max(height)).clamp(1000, 500_000_000) as i32;
    let Bounds { min, max } = bounds.grown(out);
    let middle = |a: i32, b: i32| ((i64::from(a) + i64::from(b)) / 2) as i32;
    let (x, y) = (middle(min.x, max.x), middle(min.y, max.y));
    let sides = [(min.x, y), (max.x, y), (x, min.y), (x, max.y)];
    let corners = [(min.x, min.y), (max.x, min.y), (max.x, max.y), (min.x, max.y)];
    sides.into_iter().chain(corners).map(|(x, y)| Point::new(x, y))
}

#[cfg(test)]
mod tests {
    use super::super::{intersection, union_all};
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn cells_hold_what_is_nearest_to_them_and_divide_the_box(
            points in proptest::collection::vec(((-5000..5000i32, -5000..5000i32), 0..4u8), 2..60),
            places in proptest::collection::vec((-5000..5000i32, -5000..5000i32), 20),
        ) {
            let mut points: Vec<(Point, u8)> = points.into_iter().map(|((x, y), kind)| (Point::new(x, y), kind)).collect();
            points.sort_unstable_by_key(|(point, _)| *point);
            points.dedup_by_key(|(point, _)| *point);
            let cells = nearest_kinds(&points);
            let bounds = Bounds::of(points.iter().map(|(point, _)| *point)).unwrap();
            for place in places.into_iter().map(|(x, y)| Point::new(x, y)).filter(|place| bounds.holds(*place)) {
                let mut near: Vec<(i64, u8)> = points.iter().map(|(point, kind)| (point.distance2(place), *kind)).collect();
                near.sort_unstable();
                // Corners of cells are rounded to the grid.
                let far = near.iter().find(|other| other.1 != near[0].1).map_or(i64::MAX, |other| other.0);
                if (far as f64).sqrt() - (near[0].0 as f64).sqrt() > 3.0 {
                    for (kind, region) in &cells {
                        prop_assert_eq!(region.contains(place), *kind == near[0].1);
                    }
                }
            }
            let whole = union_all(cells.iter().map(|(_, region)| region)).area_mm2();
            let sum: f64 = cells.iter().map(|(_, region)| region.area_mm2()).sum();
            prop_assert!((whole - sum).abs() < 1e-6 * whole, "{} of {}", sum, whole);
            for (i, a) in cells.iter().enumerate() {
                for b in &cells[..i] {
                    prop_assert!(intersection(&a.1, &b.1).area_mm2() < 1e-6 * whole);
                }
            }
        }
    }
}
