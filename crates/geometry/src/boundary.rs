//! Positions on the boundary of a region, and the paths between them along it.

use std::borrow::Cow;

use crate::real;

use super::point::{cross, to_segment_mm};
use super::{Point, Region};

/// A position on the boundary of a region.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BoundaryPos {
    /// Index of the ring in the order of [`Region::rings`].
    pub ring: u32,
    /// Index of the edge: from vertex `edge` to the next one of the ring.
    pub edge: u32,
    /// Distance from the start of the edge, in millimetres.
    pub along_mm: f64,
}

/// The rings of a region with their running lengths: how far apart two positions on one ring are, and what
/// lies between them.
#[derive(Clone, Debug)]
pub struct Boundary<'a> {
    rings: Vec<Cow<'a, [Point]>>,
    /// For each ring the distance from its first vertex to every vertex, then the whole length.
    running_mm: Vec<Vec<f64>>,
}

impl<'a> Boundary<'a> {
    /// Measures the rings of a region. O(vertices).
    pub fn new(region: &'a Region) -> Self {
        let rings: Vec<Cow<[Point]>> = region.rings().map(Cow::from).collect();
        let running_mm = rings
            .iter()
            .map(|ring| {
                let mut sum = 0.0;
                let next = ring.iter().cycle().skip(1);
                std::iter::once(0.0)
                    .chain(ring.iter().zip(next).map(|(a, b)| {
                        sum += a.distance_mm(*b);
                        sum
                    }))
                    .collect()
            })
            .collect();
        Self { rings, running_mm }
    }

    /// The same with rings of its own, for keeping it beyond the region.
    pub fn into_owned(self) -> Boundary<'static> {
        let rings = self.rings.into_iter().map(|ring| Cow::Owned(ring.into_owned())).collect();
        Boundary { rings, running_mm: self.running_mm }
    }

    /// Length of a ring in millimetres; 0 where there is no such ring.
    pub fn ring_length_mm(&self, ring: u32) -> f64 {
        self.running_mm.get(ring as usize).and_then(|r| r.last()).copied().unwrap_or(0.0)
    }

    /// Distance from the first vertex of its ring, along the ring, in millimetres.
    pub fn distance_mm(&self, at: BoundaryPos) -> f64 {
        let start = self.running_mm.get(at.ring as usize).and_then(|r| r.get(at.edge as usize));
        start.copied().unwrap_or(0.0) + at.along_mm
    }

    /// Length of the path from one position to another along their ring, in the ring's direction, in millimetres;
    /// backwards it is the ring's length less this. `None` where they are on different rings.
    pub fn forward_mm(&self, from: BoundaryPos, to: BoundaryPos) -> Option<f64> {
        (from.ring == to.ring).then(|| {
            let length_mm = self.distance_mm(to) - self.distance_mm(from);
            if length_mm < 0.0 { length_mm + self.ring_length_mm(from.ring) } else { length_mm }
        })
    }

    /// The path of a given length from a position along its ring, in the ring's direction if `forward`: the vertices that it passes
    /// and the point where it ends. At most once round.
    pub fn walk(&self, from: BoundaryPos, length_mm: f64, forward: bool) -> Vec<Point> {
        let Some(ring) = self.rings.get(from.ring as usize).filter(|ring| !ring.is_empty()) else {
            return Vec::new();
        };
        let (n, edge) = (ring.len(), from.edge as usize);
        let vertex =
            |step: usize| if forward { ring[(edge + 1 + step) % n] } else { ring[(edge + n - step % n) % n] };
        let side_mm = ring[edge].distance_mm(ring[(edge + 1) % n]);
        let mut left_mm = length_mm;
        let mut path = Vec::new();
        // Where on the edge from the vertex behind to the next one the path begins.
        let (mut behind, mut begun_mm) = match forward {
            true => (ring[edge], from.along_mm),
            false => (ring[(edge + 1) % n], side_mm - from.along_mm),
        };
        for step in 0..=n {
            let next = vertex(step);
            let rest_mm = behind.distance_mm(next) - begun_mm;
            if rest_mm >= left_mm {
                let t = (begun_mm + left_mm) / behind.distance_mm(next).max(f64::MIN_POSITIVE);
                let ([ax, ay], [bx, by]) = (behind.mm(), next.mm());
                path.push(Point::from_mm(ax + t * (bx - ax), ay + t * (by - ay)));
                break;
            }
            path.push(next);
            left_mm -= rest_mm;
            (behind, begun_mm) = (next, 0.0);
        }
        path
    }

    /// Unit vector along the edge of a position; `None` of an edge without length or a position that is not there.
    pub fn direction(&self, at: BoundaryPos) -> Option<[f64; 2]> {
        let ring = self.rings.get(at.ring as usize)?;
        let a = ring.get(at.edge as usize)?;
        let b = ring[(at.edge as usize + 1) % ring.len()];
        let (length_mm, [ax, ay], [bx, by]) = (a.distance_mm(b), a.mm(), b.mm());
        (length_mm > 0.0).then(|| [(bx - ax) / length_mm, (by - ay) / length_mm])
    }

    /// Whether a point is at most a distance in millimetres outside of the region, as far as the edges near a position on its
    /// boundary tell: those at most twice as far along the ring as the point is away. Corners that stick out are sharp: beyond
    /// them, the lines of both edges count. O(edges near).
    pub fn reaches(&self, from: BoundaryPos, to_mm: [f64; 2], distance_mm: f64) -> bool {
        let Some(ring) = self.rings.get(from.ring as usize).filter(|ring| !ring.is_empty()) else {
            return true;
        };
        let n = ring.len();
        let side = |edge: usize| [ring[edge % n].mm(), ring[(edge + 1) % n].mm()];
        let outside_mm = |edge: usize| {
            let [a, b] = side(edge);
            let along = [b[0] - a[0], b[1] - a[1]];
            cross([to_mm[0] - a[0], to_mm[1] - a[1]], along)
                / real::hypot(along[0], along[1]).max(f64::MIN_POSITIVE)
        };
        let first = from.edge as usize % n;
        let [a, b] = side(first);
        let length_mm = ring[first].distance_mm(ring[(first + 1) % n]);
        let t = from.along_mm / length_mm.max(f64::MIN_POSITIVE);
        let start = [0, 1].map(|k| a[k] + t * (b[k] - a[k]));
        let range_mm = 2.0 * real::hypot(to_mm[0] - start[0], to_mm[1] - start[1]);
        let mut nearest = (f64::INFINITY, first);
        let mut look = |edge: usize| {
            let [a, b] = side(edge);
            let mm = to_segment_mm(to_mm, a, b);
            if mm < nearest.0 {
                nearest = (mm, edge);
            }
            mm <= distance_mm
        };
        if look(first) {
            return true;
        }
        for (step, begun_mm) in [(1, length_mm - from.along_mm), (n - 1, from.along_mm)] {
            let (mut edge, mut passed_mm) = ((first + step) % n, begun_mm);
            while edge != first && passed_mm <= range_mm {
                if look(edge) {
                    return true;
                }
                passed_mm += ring[edge].distance_mm(ring[(edge + 1) % n]);
                edge = (edge + step) % n;
            }
        }
        let edge = nearest.1;
        let [a, b] = side(edge);
        let along = [b[0] - a[0], b[1] - a[1]];
        let dot = (to_mm[0] - a[0]) * along[0] + (to_mm[1] - a[1]) * along[1];
        let neighbour = if dot <= 0.0 {
            edge + n - 1
        } else if dot >= along[0] * along[0] + along[1] * along[1] {
            edge + 1
        } else {
            edge
        };
        outside_mm(edge).max(outside_mm(neighbour)) <= distance_mm
    }

    /// The vertices strictly between two positions of one ring, in the ring's direction if `forward`, else
    /// against it. Empty where the positions are on different rings or share an edge with nothing between.
    pub fn vertices_between(&self, from: BoundaryPos, to: BoundaryPos, forward: bool) -> Vec<Point> {
        if !forward {
            let mut vertices = self.vertices_between(to, from, true);
            vertices.reverse();
            return vertices;
        }
        let Some(ring) = self.rings.get(from.ring as usize).filter(|_| from.ring == to.ring) else {
            return Vec::new();
        };
        let (n, first, last) = (ring.len(), from.edge as usize, to.edge as usize);
        if n == 0 {
            return Vec::new();
        }
        let direct = first == last && from.along_mm <= to.along_mm;
        let count = if direct { 0 } else { (last + n - first - 1) % n + 1 };
        (1..=count).map(|i| ring[(first + i) % n]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Polygon;

    fn square() -> Region {
        let corner = |x, y| Point::from_mm(x, y);
        let outer = vec![corner(0.0, 0.0), corner(10.0, 0.0), corner(10.0, 10.0), corner(0.0, 10.0)];
        Region { polygons: vec![Polygon { outer, holes: vec![] }] }
    }

    fn at(edge: u32, along_mm: f64) -> BoundaryPos {
        BoundaryPos { ring: 0, edge, along_mm }
    }

    #[test]
    fn both_directions_make_the_whole_ring() {
        let region = square();
        let boundary = Boundary::new(&region);
        let (a, b) = (at(0, 3.0), at(2, 4.0));
        assert_eq!(boundary.forward_mm(a, b), Some(21.0));
        assert_eq!(boundary.forward_mm(b, a), Some(19.0));
        assert_eq!(boundary.ring_length_mm(0), 40.0);
    }

    #[test]
    fn a_walk_of_a_length_ends_where_a_path_of_that_length_does() {
        let region = square();
        let boundary = Boundary::new(&region);
        let corners = &region.polygons[0].outer;
        assert_eq!(boundary.walk(at(0, 3.0), 5.0, true), [Point::from_mm(8.0, 0.0)]);
        assert_eq!(
            boundary.walk(at(0, 3.0), 21.0, true),
            [corners[1], corners[2], Point::from_mm(6.0, 10.0)]
        );
        assert_eq!(boundary.walk(at(0, 3.0), 5.0, false), [corners[0], Point::from_mm(0.0, 2.0)]);
    }

    #[test]
    fn the_path_passes_the_corners_between() {
        let region = square();
        let boundary = Boundary::new(&region);
        let corners = &region.polygons[0].outer;
        assert_eq!(boundary.vertices_between(at(0, 3.0), at(2, 4.0), true), corners[1..3]);
        assert_eq!(boundary.vertices_between(at(0, 3.0), at(2, 4.0), false), [corners[0], corners[3]]);
        assert!(boundary.vertices_between(at(1, 3.0), at(1, 4.0), true).is_empty());
        assert_eq!(boundary.vertices_between(at(1, 4.0), at(1, 3.0), true).len(), 4);
    }

    #[test]
    fn a_corner_that_sticks_out_reaches_to_where_both_edges_are_so_far_away() {
        let region = square();
        let boundary = Boundary::new(&region);
        // Just before the corner at (10, 0).
        let reaches = |x, y| boundary.reaches(at(0, 9.9), [x, y], 0.5);
        assert!(reaches(10.4, -0.4) && reaches(9.9, -0.5) && reaches(9.0, 1.0));
        assert!(!reaches(10.6, -0.4) && !reaches(10.4, -0.6) && !reaches(10.6, 0.4));
        // Far from the corner only the edge itself counts.
        assert!(
            boundary.reaches(at(0, 5.0), [5.0, -0.5], 0.5) && !boundary.reaches(at(0, 5.0), [5.0, -0.6], 0.5)
        );
    }

    #[test]
    fn around_a_corner_that_sticks_in_one_edge_is_enough() {
        let mut region = square();
        let hole = [(4.0, 4.0), (4.0, 6.0), (6.0, 6.0), (6.0, 4.0)];
        region.polygons[0].holes.push(hole.map(|(x, y)| Point::from_mm(x, y)).to_vec());
        let boundary = Boundary::new(&region);
        let left = |along_mm| BoundaryPos { ring: 1, edge: 0, along_mm };
        assert!(boundary.reaches(left(0.1), [5.0, 4.3], 0.5) && boundary.reaches(left(0.1), [4.3, 5.0], 0.5));
        assert!(!boundary.reaches(left(1.0), [5.0, 5.0], 0.5));
    }
}
