//! The boundary of a polygon as evenly spaced samples.

use crate::simplify::simplify_ring;
use crate::{Polygon, UNITS_PER_MM};

/// Positions in millimetres.
pub(super) type Position = [f64; 2];

/// Vertices closer to their neighbours' line than this are no feature of a bead: 5 µm.
const SIMPLIFY_MM: f64 = 0.005;

/// How many edges on either side of a sample may hold the nearest point of its side.
const MAX_STEPS: usize = 16;

/// Samples along all rings of a polygon, with their neighbours.
pub(super) struct Outline {
    pub(super) at: Vec<Position>,
    pub(super) next: Vec<u32>,
    before: Vec<u32>,
}

impl Outline {
    /// Samples at the vertices and between them, at most `spacing_mm` apart.
    pub(super) fn sample(polygon: &Polygon, spacing_mm: f64) -> Self {
        let mut outline = Self { at: Vec::new(), next: Vec::new(), before: Vec::new() };
        for ring in polygon.rings() {
            let ring = simplify_ring(ring, SIMPLIFY_MM * UNITS_PER_MM);
            let first = outline.at.len();
            for (i, a) in ring.iter().enumerate() {
                let b = ring[(i + 1) % ring.len()];
                let parts = (a.distance_mm(b) / spacing_mm).ceil().max(1.0);
                for k in 0..parts as usize {
                    outline.at.push(lerp(a.mm(), b.mm(), k as f64 / parts));
                }
            }
            let end = outline.at.len();
            for i in first..end {
                outline.before.push(if i == first { end } else { i } as u32 - 1);
                outline.next.push(if i + 1 == end { first } else { i + 1 } as u32);
            }
        }
        outline
    }

    /// The point nearest to `p` on the boundary around a sample, on the sample's side of the perpendicular through
    /// `middle`, and not much farther along the boundary from the sample than that.
    pub(super) fn nearest_around(&self, sample: u32, p: Position, middle: Position) -> Position {
        let mut best = self.at[sample as usize];
        let mut best_mm = distance(p, best);
        let reach = distance(best, middle);
        let out = direction(middle, best);
        let is_beside = |q: Position| (q[0] - middle[0]) * out[0] + (q[1] - middle[1]) * out[1] > 0.0;
        for neighbours in [&self.next, &self.before] {
            let (mut a, mut walked) = (sample, 0.0);
            for _ in 0..MAX_STEPS {
                let b = neighbours[a as usize];
                let (from, to) = (self.at[a as usize], self.at[b as usize]);
                let q = nearest_on(from, to, p);
                let mm = distance(p, q);
                if mm < best_mm && is_beside(q) {
                    (best, best_mm) = (q, mm);
                }
                walked += distance(from, to);
                if walked >= reach {
                    break;
                }
                a = b;
            }
        }
        best
    }
}

pub(super) fn lerp(a: Position, b: Position, t: f64) -> Position {
    [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]
}

pub(super) fn distance(a: Position, b: Position) -> f64 {
    let (dx, dy) = (a[0] - b[0], a[1] - b[1]);
    (dx * dx + dy * dy).sqrt()
}

/// The unit vector from `a` to `b`; zero where they are the same.
pub(super) fn direction(a: Position, b: Position) -> Position {
    let length = distance(a, b);
    if length > 0.0 { [(b[0] - a[0]) / length, (b[1] - a[1]) / length] } else { [0.0, 0.0] }
}

fn nearest_on(a: Position, b: Position, p: Position) -> Position {
    let d = [b[0] - a[0], b[1] - a[1]];
    let length2 = d[0] * d[0] + d[1] * d[1];
    let t = ((p[0] - a[0]) * d[0] + (p[1] - a[1]) * d[1]) / length2;
    if t > 0.0 { lerp(a, b, t.min(1.0)) } else { a }
}
