//! Beads along a boundary whose vertices were moved inwards, without the folds that this makes at its corners.

use geometry::Point;

/// A vertex of a bead, and what follows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Vertex {
    pub at: Point,
    pub spacing_mm: f64,
    /// The direction of the boundary from here to the next vertex.
    pub ahead: [f64; 2],
}

/// Vertices that became one: sums of their coordinates and spacings, and how many they are.
#[derive(Clone, Copy)]
struct Cluster {
    x: i64,
    y: i64,
    spacing_mm: f64,
    count: i64,
    /// Of its last vertex.
    ahead: [f64; 2],
}

impl Cluster {
    fn of(vertex: &Vertex) -> Self {
        let Vertex { at, spacing_mm, ahead } = *vertex;
        Self { x: at.x.into(), y: at.y.into(), spacing_mm, count: 1, ahead }
    }

    fn vertex(&self) -> Vertex {
        let mean = |sum: i64| (sum as f64 / self.count as f64).round() as i32;
        let at = Point { x: mean(self.x), y: mean(self.y) };
        Vertex { at, spacing_mm: self.spacing_mm / self.count as f64, ahead: self.ahead }
    }

    fn joined(&self, next: &Self) -> Self {
        Self {
            x: self.x + next.x,
            y: self.y + next.y,
            spacing_mm: self.spacing_mm + next.spacing_mm,
            count: self.count + next.count,
            ahead: next.ahead,
        }
    }

    /// Whether the bead from here to the next goes against the boundary.
    fn goes_back_to(&self, next: &Self) -> bool {
        let (from, to) = (self.vertex().at, next.vertex().at);
        let along = [to.x - from.x, to.y - from.y].map(f64::from);
        along[0] * self.ahead[0] + along[1] * self.ahead[1] < 0.0
    }
}

/// A closed bead whose every piece runs along its boundary: where it goes back, the vertices between become one, in their
/// middle. O(n).
pub(super) fn unfold(vertices: &[Vertex]) -> Vec<Vertex> {
    let mut kept: Vec<Cluster> = Vec::with_capacity(vertices.len());
    for vertex in vertices {
        let mut next = Cluster::of(vertex);
        while let Some(last) = kept.last().filter(|last| last.goes_back_to(&next)) {
            next = last.joined(&next);
            kept.pop();
        }
        kept.push(next);
    }
    // Where the ring closes.
    while let [first, .., last] = kept[..]
        && last.goes_back_to(&first)
    {
        kept.pop();
        kept[0] = Cluster { ahead: first.ahead, ..last.joined(&first) };
    }
    kept.iter().map(Cluster::vertex).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bead_moved_in_further_than_its_arc_is_round_does_not_fold() {
        // A square whose corner at (1, 1) is an arc of 0.1 mm, and the bead 0.15 mm inside of it.
        const STEPS: u32 = 12;
        let vertex = |x: f64, y: f64, ahead| Vertex { at: Point::from_mm(x, y), spacing_mm: 0.5, ahead };
        let around = |k: f64| (std::f64::consts::FRAC_PI_2 * k / f64::from(STEPS)).sin_cos();
        let mut bead = vec![vertex(0.15, 0.15, [1.0, 0.0]), vertex(0.85, 0.15, [0.0, 1.0])];
        bead.extend((0..=STEPS).map(f64::from).map(|k| {
            let ((y, x), (ahead_y, ahead_x)) = (around(k), around(k + 0.5));
            let ahead = if k < f64::from(STEPS) { [-ahead_y, ahead_x] } else { [-1.0, 0.0] };
            vertex(0.9 - 0.05 * x, 0.9 - 0.05 * y, ahead)
        }));
        bead.push(vertex(0.15, 0.85, [0.0, -1.0]));
        let unfolded = unfold(&bead);
        assert_eq!(unfolded.len(), 4, "{unfolded:?}");
        assert!(unfolded[2].at.distance_mm(Point::from_mm(0.85, 0.85)) < 0.03, "{unfolded:?}");
        assert_eq!(unfold(&unfolded), unfolded);
    }
}
