//! Positions on the boundary of a region, and the paths between them along it.

use std::borrow::Cow;

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
}
