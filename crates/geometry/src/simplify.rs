//! Fewer vertices for the same outline.

use super::{Point, Region, Ring, UNITS_PER_MM, unite_rings};

/// How many vertices one new edge may replace. It bounds the look-back, so that the cost stays linear.
const MAX_RUN: usize = 48;

/// A region with the vertices left out that move the boundary by at most `tol_mm`.
///
/// The result has no self-intersections and keeps windings; rings that vanish are gone. Outlines nearer to each
/// other than the tolerance may merge. O(vertices) but for outlines that had to be united again.
pub fn simplify(region: &Region, tol_mm: f64) -> Region {
    unite_rings(&region.rings().map(|ring| simplify_ring(ring, tol_mm * UNITS_PER_MM)).collect::<Vec<_>>())
}

/// A ring with the vertices left out that are within `tol` units of the new edge in their place, starting at its
/// leftmost (then lowest) vertex. It may touch or cross itself where it is narrower than the tolerance.
/// Rings of no more than two distinct points come out empty.
pub(super) fn simplify_ring(ring: &[Point], tol: f64) -> Ring {
    let mut kept = Ring::with_capacity(ring.len());
    simplify_into(ring, tol, &mut kept);
    kept
}

/// [`simplify_ring`], which replaces the contents of `kept`.
pub(super) fn simplify_into(ring: &[Point], tol: f64, kept: &mut Ring) {
    kept.clear();
    let Some(start) = leftmost(ring) else { return };
    let tol2 = tol * tol;
    let at = |i: usize| ring[if i < ring.len() { i } else { i - ring.len() }];
    let end = start + ring.len();
    kept.push(ring[start]);
    let (mut anchor, mut next) = (start, at(start + 1));
    for i in start + 1..end {
        // Vertex i goes if the edge from the anchor to the next vertex is near all that it would replace.
        let vertex = std::mem::replace(&mut next, at(i + 1));
        let edge = Edge::new(at(anchor), next);
        let drops = i - anchor < MAX_RUN
            && edge.is_near(vertex, tol2)
            && (anchor + 1..i).rev().all(|k| edge.is_near(at(k), tol2));
        if !drops {
            if kept.last() != Some(&vertex) {
                kept.push(vertex);
            }
            anchor = i;
        }
    }
    if kept.len() > 1 && kept.last() == kept.first() {
        kept.pop();
    }
    if kept.len() < 3 {
        kept.clear();
    }
}

/// The leftmost vertex, of those the lowest, of equal ones the first; `None` of nothing.
fn leftmost(ring: &[Point]) -> Option<usize> {
    let (mut found, mut least) = (0, *ring.first()?);
    for (i, &p) in ring.iter().enumerate() {
        if p.x < least.x || (p.x == least.x && p.y < least.y) {
            (found, least) = (i, p);
        }
    }
    Some(found)
}

/// A new edge in the place of vertices.
struct Edge {
    from: Point,
    by: [f64; 2],
    length2: f64,
}

impl Edge {
    #[inline]
    fn new(from: Point, to: Point) -> Self {
        let by = [f64::from(to.x) - f64::from(from.x), f64::from(to.y) - f64::from(from.y)];
        Self { from, by, length2: by[0] * by[0] + by[1] * by[1] }
    }

    /// Whether a point is within the square root of `tol2` of it.
    #[inline]
    fn is_near(&self, p: Point, tol2: f64) -> bool {
        let ([dx, dy], length2) = (self.by, self.length2);
        let (px, py) = (f64::from(p.x) - f64::from(self.from.x), f64::from(p.y) - f64::from(self.from.y));
        let dot = px * dx + py * dy;
        if dot <= 0.0 {
            px * px + py * py <= tol2
        } else if dot >= length2 {
            (px - dx) * (px - dx) + (py - dy) * (py - dy) <= tol2
        } else {
            let cross = px * dy - py * dx;
            cross * cross <= tol2 * length2
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_circle_keeps_what_its_tolerance_needs() {
        let circle: Ring = (0..2000)
            .map(|i| {
                let angle = f64::from(i) * std::f64::consts::TAU / 2000.0;
                Point::from_mm(10.0 * angle.cos(), 10.0 * angle.sin())
            })
            .collect();
        let slim = simplify_ring(&circle, 250.0);
        assert!((100..200).contains(&slim.len()), "{}", slim.len());
        for p in &circle {
            let edges = (0..slim.len()).map(|i| Edge::new(slim[i], slim[(i + 1) % slim.len()]));
            assert!(edges.into_iter().any(|edge| edge.is_near(*p, 250.0 * 250.0)));
        }
    }

    #[test]
    fn straight_runs_and_twins_go() {
        let points = [(0, 0), (0, 0), (50, 0), (51, 0), (100, 0), (100, 100), (99, 100), (0, 100), (0, 50)];
        let ring: Ring = points.iter().map(|&(x, y)| Point::new(x, y)).collect();
        let corners = [(0, 0), (100, 0), (100, 100), (0, 100)].map(|(x, y)| Point::new(x, y));
        assert_eq!(simplify_ring(&ring, 0.0), corners);
    }

    #[test]
    fn a_sliver_vanishes() {
        let sliver = [Point::new(0, 0), Point::new(1000, 1), Point::new(2000, 0)];
        assert!(simplify_ring(&sliver, 2.0).is_empty());
    }
}
