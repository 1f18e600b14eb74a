//! Outer walls, which an oozing nozzle must not cross, and detours around them.

use std::sync::OnceLock;

use super::block::Block;
use geometry::{
    Boundary, BoundaryPos, Bounds, Clipper, Point, Polygon, Region, Ring, UNITS_PER_MM, offset, ring_area,
    unite_rings,
};

/// Gaps of seams are closed up to this, mm.
const SEAM_GAP_MM: f64 = 1.0;
/// Crossings this near to an end of a travel are that end's own wall, mm.
const OWN_WALL_MM: f64 = 0.25;
/// Detours keep this far from the middle of the walls, mm: over the next bead inside, or else, where it is
/// narrow, between two beads that touch.
const CLEARANCES_MM: [f64; 2] = [0.4, 0.15];
/// How far the route along the inside a wall may be from where it is entered, mm.
const REACH_MM: f64 = 1.5;

/// How a straight travel lies relative to the walls of its layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TravelKind {
    /// Within one part.
    Inside,
    /// Through the open, touching no part.
    Outside,
    /// Across a wall.
    Crosses,
}

/// The outer walls of a layer.
#[derive(Debug)]
pub struct Walls {
    rings: Vec<Ring>,
    clipper: Clipper,
    insets: [OnceLock<Inset>; 2],
}

/// Where the nozzle is inside a part and clear of its walls.
#[derive(Debug)]
struct Inset {
    region: Region,
    boundary: Boundary<'static>,
    clipper: Clipper,
}

impl Walls {
    /// The walls of the blocks of one layer. Where nothing is said of roles, every loop may be one.
    pub fn new<'a>(blocks: impl Iterator<Item = &'a Block>) -> Self {
        let mut rings: Vec<Ring> = Vec::new();
        for block in blocks {
            for path in &block.paths {
                let outer = match path.role {
                    Some(role) => role.is_outer_wall(),
                    None => block.closed(path),
                };
                if !outer {
                    continue;
                }
                let mut ring: Ring = block.points(path).map(|[x, y]| Point::from_mm(x, y)).collect();
                let (first, last) = (ring[0], ring[ring.len() - 1]);
                if first.distance_mm(last) < SEAM_GAP_MM && ring.len() > 3 {
                    ring.dedup();
                    ring.pop_if(|last| *last == first);
                    rings.push(ring);
                }
            }
        }
        let ring = |ring: &Ring| Polygon { outer: ring.clone(), holes: Vec::new() };
        // The clipper goes by the even-odd rule: how the rings are nested does not matter to it.
        let clipper = Clipper::new(&Region::disjoint(rings.iter().map(ring)));
        Self { rings, clipper, insets: Default::default() }
    }

    /// Whether there are no walls, so that nothing restricts travel.
    pub fn is_empty(&self) -> bool {
        self.rings.is_empty()
    }

    /// How the straight travel between two points lies.
    pub(super) fn classify(&self, a: Point, b: Point) -> TravelKind {
        let pieces = self.clipper.clip(&[a, b]);
        let (Some(first), Some(last)) = (pieces.first(), pieces.last()) else { return TravelKind::Outside };
        let (enter, leave) = (first.points[0], last.points[last.points.len() - 1]);
        let own =
            pieces.len() == 1 && enter.distance_mm(a) < OWN_WALL_MM && leave.distance_mm(b) < OWN_WALL_MM;
        let length_mm: f64 =
            pieces.iter().map(|p| p.points[0].distance_mm(p.points[p.points.len() - 1])).sum();
        match own {
            true => TravelKind::Inside,
            false if length_mm < OWN_WALL_MM => TravelKind::Outside,
            false => TravelKind::Crosses,
        }
    }

    /// Corners of a route along the walls, inside the part, between two points whose straight line crosses walls;
    /// `None` if there is none or it is too long.
    pub fn around(&self, a: Point, b: Point) -> Option<Vec<Point>> {
        self.insets.iter().zip(CLEARANCES_MM).find_map(|(inset, clearance_mm)| {
            self.around_in(inset.get_or_init(|| self.inset(clearance_mm)), a, b)
        })
    }

    fn around_in(&self, inset: &Inset, a: Point, b: Point) -> Option<Vec<Point>> {
        let pieces = inset.clipper.clip(&[a, b]);
        let mut route = vec![a];
        // Where the route has left the inset and must go along its boundary.
        let mut left = match pieces.first().map(|piece| piece.ends[0]) {
            Some(None) => None,
            _ => Some(inset.nearest(a)?),
        };
        for piece in &pieces {
            if let (Some(from), Some(to)) = (left, piece.ends[0]) {
                along(&inset.boundary, from, to, &mut route)?;
            }
            route.extend([piece.points[0], piece.points[piece.points.len() - 1]]);
            left = piece.ends[1];
        }
        if let Some(from) = left {
            along(&inset.boundary, from, inset.nearest(b)?, &mut route)?;
        }
        route.push(b);
        route.dedup();
        let route = self.tightened(&route)?;
        let length_mm: f64 = route.windows(2).map(|w| w[0].distance_mm(w[1])).sum();
        (length_mm < 2.0 * a.distance_mm(b) + 10.0).then(|| route[1..route.len() - 1].to_vec())
    }

    /// Leaves out corners that are not needed. `None` where a part of the route crosses a wall after all.
    fn tightened(&self, route: &[Point]) -> Option<Vec<Point>> {
        let free = |i: usize, j: usize| self.classify(route[i], route[j]) == TravelKind::Inside;
        let mut out = vec![route[0]];
        let mut at = 0;
        while at + 1 < route.len() {
            let mut step = 1;
            if !free(at, at + 1) {
                return None;
            }
            while at + 2 * step < route.len() && free(at, at + 2 * step) {
                step *= 2;
            }
            let (mut good, mut bad) = (step, (2 * step).min(route.len() - at));
            while good + 1 < bad {
                let middle = good.midpoint(bad);
                if free(at, at + middle) { good = middle } else { bad = middle }
            }
            at += good;
            out.push(route[at]);
        }
        Some(out)
    }

    fn inset(&self, clearance_mm: f64) -> Inset {
        let boxes: Vec<Option<Bounds>> =
            self.rings.iter().map(|ring| Bounds::of(ring.iter().copied())).collect();
        let alone = |ring: &Ring| Polygon { outer: ring.clone(), holes: Vec::new() };
        let regions: Vec<Region> = self.rings.iter().map(|ring| Region::from(alone(ring))).collect();
        let around = |inner: usize, outer: usize| {
            let p = self.rings[inner][0];
            let near = boxes[outer].is_some_and(|b| b.holds(p));
            inner != outer && near && regions[outer].contains(p)
        };
        let turned = (0..self.rings.len()).map(|i| {
            let depth = (0..self.rings.len()).filter(|&outer| around(i, outer)).count();
            let mut ring = self.rings[i].clone();
            if (ring_area(&ring) > 0.0) != (depth % 2 == 0) {
                ring.reverse();
            }
            ring
        });
        let region = offset(&unite_rings(&turned.collect::<Vec<_>>()), -clearance_mm);
        Inset { clipper: Clipper::new(&region), boundary: Boundary::new(&region).into_owned(), region }
    }
}

impl Inset {
    /// The position on the boundary nearest to a point, if it is near enough.
    fn nearest(&self, p: Point) -> Option<BoundaryPos> {
        let mut best: Option<(f64, BoundaryPos)> = None;
        for (ring_index, ring) in self.region.rings().enumerate() {
            for (edge, &a) in ring.iter().enumerate() {
                let b = ring[if edge + 1 == ring.len() { 0 } else { edge + 1 }];
                let away = |p: i32, a: i32, b: i32| {
                    let reach = REACH_MM * UNITS_PER_MM;
                    f64::from(a.min(b)) - reach > f64::from(p) || f64::from(a.max(b)) + reach < f64::from(p)
                };
                if away(p.x, a.x, b.x) || away(p.y, a.y, b.y) {
                    continue;
                }
                let (d, w) = (b - a, p - a);
                let length2 = d.dot(d).max(1) as f64;
                let share = (w.dot(d) as f64 / length2).clamp(0.0, 1.0);
                let along_mm = share * a.distance_mm(b);
                let foot = foot(a, b, share);
                let distance_mm = foot.distance_mm(p);
                if distance_mm < REACH_MM && best.is_none_or(|(least, _)| distance_mm < least) {
                    let at = BoundaryPos { ring: ring_index as u32, edge: edge as u32, along_mm };
                    best = Some((distance_mm, at));
                }
            }
        }
        best.map(|(_, at)| at)
    }
}

fn foot(a: Point, b: Point, share: f64) -> Point {
    let [p, q] = [a.mm(), b.mm()];
    Point::from_mm(p[0] + share * (q[0] - p[0]), p[1] + share * (q[1] - p[1]))
}

/// Goes along the boundary, in the shorter direction. `None` where that is not possible.
fn along(boundary: &Boundary<'_>, from: BoundaryPos, to: BoundaryPos, route: &mut Vec<Point>) -> Option<()> {
    let forward_mm = boundary.forward_mm(from, to)?;
    let forward = forward_mm <= boundary.ring_length_mm(from.ring) - forward_mm;
    route.extend(boundary.vertices_between(from, to, forward));
    Some(())
}

#[cfg(test)]
mod tests {
    use super::super::Blocks;
    use super::*;

    #[test]
    fn a_detour_is_found_through_a_strip_of_two_beads() {
        // A U whose legs are 0.5 mm wide.
        let mut text = String::from("M83\n;TYPE:WALL-OUTER\nG1 X0 Y0 F900\n");
        for (x, y) in
            [(4.0, 0.0), (4.0, 4.0), (3.5, 4.0), (3.5, 0.5), (0.5, 0.5), (0.5, 4.0), (0.0, 4.0), (0.0, 0.0)]
        {
            text += &format!("G1 X{x} Y{y} E1\n");
        }
        let block = Blocks::new(text.as_bytes()).read().expect("read").expect("a block");
        let walls = Walls::new([&block].into_iter());
        let [a, b] = [0.25, 3.75].map(|x| Point::from_mm(x, 3.5));
        assert_eq!(walls.classify(a, b), TravelKind::Crosses);
        let corners = walls.around(a, b).expect("a route");
        let route: Vec<Point> = [a].into_iter().chain(corners).chain([b]).collect();
        assert!(
            route.len() > 3 && route.windows(2).all(|w| walls.classify(w[0], w[1]) == TravelKind::Inside),
            "{route:?}"
        );
    }
}
