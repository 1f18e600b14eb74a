//! Fewer vertices within a tolerance.

use geometry::{Cone, Point, Ring, UNITS_PER_MM};

/// Drops vertices that move the outline by at most `tolerance_mm`, and keeps the area: each edge that replaces a
/// chain moves sideways by the mean distance of that chain, so that finely drawn circles do not shrink.
///
/// Vertices are dropped by intersection of cones ([`Cone`]), from the lexicographically least vertex on, so that the result does not depend on where the ring begins. What is left of a ring thinner than the
/// tolerance has less than three vertices. O(n).
pub(super) fn simplify(ring: &mut Ring, tolerance_mm: f64) {
    if ring.len() > 1 && ring.first() == ring.last() {
        ring.pop();
    }
    let tolerance = tolerance_mm * UNITS_PER_MM;
    if ring.len() < 4 || tolerance < 1.0 {
        return;
    }
    let least = (0..ring.len()).min_by_key(|&i| (ring[i].x, ring[i].y)).unwrap_or(0);
    ring.rotate_left(least);
    ring.push(ring[0]);
    let mut edges = Vec::with_capacity(ring.len() / 2);
    let mut at = 0;
    while at + 1 < ring.len() {
        let end = reach(ring, at, tolerance);
        edges.push(Edge::across(&ring[at..=end]));
        at = end;
    }
    ring.clear();
    let mut before = edges[edges.len() - 1];
    for edge in edges {
        let point = corner(before, edge, tolerance);
        if ring.last() != Some(&point) {
            ring.push(point);
        }
        before = edge;
    }
    if ring.len() > 1 && ring.first() == ring.last() {
        ring.pop();
    }
}

/// The farthest vertex that a straight edge from `from` can go to while all vertices between stay within the tolerance.
fn reach(points: &[Point], from: usize, tolerance: f64) -> usize {
    let origin = points[from];
    let mut cone: Option<Cone> = None;
    let mut farthest = 0.0;
    let mut end = from + 1;
    loop {
        let q = points[end] - origin;
        let q = [f64::from(q.x), f64::from(q.y)];
        let distance2 = q[0] * q[0] + q[1] * q[1];
        let inside = cone.is_none_or(|cone| cone.contains(q));
        // An edge that comes back would leave the turning point out.
        if end > from + 1 && (!inside || distance2 < farthest) {
            return end - 1;
        }
        if end + 1 == points.len() {
            return end;
        }
        farthest = distance2;
        if let Some(around) = Cone::around(q, tolerance) {
            cone = Some(cone.map_or(around, |cone| cone.narrowed(around)));
        }
        end += 1;
    }
}

/// An edge that replaces a chain of edges.
#[derive(Clone, Copy)]
struct Edge {
    from: Point,
    length: f64,
    /// Unit vector to its right.
    normal: [f64; 2],
    /// How far it must move along the normal for the area to stay, in grid units.
    shift: f64,
}

impl Edge {
    fn across(chain: &[Point]) -> Self {
        let (from, to) = (chain[0], chain[chain.len() - 1]);
        let d = to - from;
        let (dx, dy) = (f64::from(d.x), f64::from(d.y));
        let length = (dx * dx + dy * dy).sqrt();
        if length == 0.0 {
            return Self { from, length, normal: [0.0; 2], shift: 0.0 };
        }
        let twice_area: f64 = chain[1..].windows(2).map(|e| (e[0] - from).cross(e[1] - from) as f64).sum();
        let shift = twice_area / 2.0 / length;
        // Less than a unit is the noise of rounding: straight edges stay what they are.
        let shift = if shift.abs() < 1.0 { 0.0 } else { shift };
        Self { from, length, normal: [dy / length, -dx / length], shift }
    }
}

/// Where two moved edges meet; the vertex moves by no more than the tolerance.
fn corner(before: Edge, after: Edge, tolerance: f64) -> Point {
    if before.shift == 0.0 && after.shift == 0.0 {
        return after.from;
    }
    let ([ax, ay], [bx, by]) = (before.normal, after.normal);
    let sine = ax * by - ay * bx;
    // Below 30° the crossing is ill defined; the mean of the two moves, weighted by length, keeps the area as well.
    let [mut dx, mut dy] = if sine.abs() > 0.5 {
        [(before.shift * by - after.shift * ay) / sine, (after.shift * ax - before.shift * bx) / sine]
    } else {
        let total = before.length + after.length;
        let mean = (before.shift * before.length + after.shift * after.length) / total;
        let widen = mean / (1.0 + ax * bx + ay * by).max(1.0);
        [(ax + bx) * widen, (ay + by) * widen]
    };
    let length = (dx * dx + dy * dy).sqrt();
    if length > tolerance {
        (dx, dy) = (dx * tolerance / length, dy * tolerance / length);
    }
    after.from + Point::new(dx.round() as i32, dy.round() as i32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::ring_area;

    fn circle(radius_mm: f64, count: usize) -> Ring {
        let angle = |i: usize| i as f64 / count as f64 * std::f64::consts::TAU;
        (0..count).map(|i| Point::from_mm(radius_mm * angle(i).cos(), radius_mm * angle(i).sin())).collect()
    }

    #[test]
    fn a_fine_circle_keeps_its_area() {
        for radius_mm in [0.5, 2.0, 20.0] {
            let fine = circle(radius_mm, 2000);
            let mut coarse = fine.clone();
            simplify(&mut coarse, 0.0125);
            let (before, after) = (ring_area(&fine), ring_area(&coarse));
            assert!(coarse.len() < fine.len() / 5, "{} vertices are left", coarse.len());
            assert!((after / before - 1.0).abs() < 1e-3, "{before} became {after}");
        }
    }

    #[test]
    fn corners_stay_and_points_on_straight_edges_go() {
        let mut ring: Ring = (0..10).map(|i| Point::from_mm(f64::from(i), 0.0)).collect();
        ring.extend([Point::from_mm(10.0, 0.0), Point::from_mm(10.0, 5.0), Point::from_mm(0.0, 5.0)]);
        simplify(&mut ring, 0.01);
        let corners = [(0.0, 0.0), (10.0, 0.0), (10.0, 5.0), (0.0, 5.0)];
        assert_eq!(ring, corners.map(|(x, y)| Point::from_mm(x, y)));
    }

    #[test]
    fn a_spike_is_not_cut_off() {
        let corners = [(0.0, 0.0), (5.0, 0.0), (5.0, 2.0), (9.0, 2.005), (5.0, 2.01), (5.0, 4.0), (0.0, 4.0)];
        let mut ring: Ring = corners.map(|(x, y)| Point::from_mm(x, y)).to_vec();
        simplify(&mut ring, 0.0125);
        assert!(ring.contains(&Point::from_mm(9.0, 2.005)));
    }
}
