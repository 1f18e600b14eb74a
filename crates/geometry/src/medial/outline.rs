//! The boundary of a polygon as evenly spaced samples.

use crate::simplify::simplify_ring;
use crate::{Polygon, UNITS_PER_MM};

/// Positions in millimetres.
pub(super) type Position = [f64; 2];

/// Vertices closer to their neighbours' line than this are no feature of a bead: 5 µm.
const SIMPLIFY_MM: f64 = 0.005;

/// How many edges on either side of a sample may hold the nearest point of its side.
const MAX_STEPS: usize = 16;

/// Vertices at which the cosine of the turn is less are corners: 37°.
const CORNER: f64 = 0.8;

/// So many samples beside a corner, and beside another vertex, are equally far apart …
const BESIDE: [usize; 2] = [4, 1];

/// … and those that follow so much farther, each than the one before.
const GROWTH: f64 = 2.0;

/// Where the samples between the ends of an edge are, as shares of its length: ever farther apart towards its middle. Of each end,
/// how many beside it are equally far apart.
fn between(length_mm: f64, spacing_mm: f64, beside: [usize; 2]) -> impl Iterator<Item = f64> {
    let least_mm = length_mm / (length_mm / spacing_mm).ceil().max(1.0);
    let [(near, from), (far, to)] = beside.map(|beside| {
        let (mut shares, mut at_mm, mut step_mm) = (Vec::new(), 0.0, least_mm);
        while at_mm + step_mm < length_mm / 2.0 {
            at_mm += step_mm;
            shares.push(at_mm / length_mm);
            if shares.len() >= beside {
                step_mm *= GROWTH;
            }
        }
        (shares, (at_mm, step_mm))
    });
    // But for rounding.
    let middle = (length_mm - from.0 - to.0 > 1.001 * from.1.min(to.1)).then_some(0.5);
    near.into_iter().chain(middle).chain(far.into_iter().rev().map(|share| 1.0 - share))
}

/// Samples along all rings of a polygon, with their neighbours.
pub(super) struct Outline {
    pub(super) at: Vec<Position>,
    pub(super) next: Vec<u32>,
    before: Vec<u32>,
}

impl Outline {
    /// Samples at the vertices and between them: beside vertices at most `spacing_mm` apart, farther off as far as they may be on
    /// straight sides.
    pub(super) fn sample(polygon: &Polygon, spacing_mm: f64) -> Self {
        let mut outline = Self { at: Vec::new(), next: Vec::new(), before: Vec::new() };
        for ring in polygon.rings() {
            let ring = simplify_ring(ring, SIMPLIFY_MM * UNITS_PER_MM);
            let first = outline.at.len();
            let n = ring.len();
            let along = |i: usize| direction(ring[i].mm(), ring[(i + 1) % n].mm());
            let beside = |i: usize| {
                let (u, v) = (along((i + n - 1) % n), along(i));
                BESIDE[usize::from(u[0] * v[0] + u[1] * v[1] >= CORNER)]
            };
            for (i, a) in ring.iter().enumerate() {
                let after = (i + 1) % n;
                let shares = between(a.distance_mm(ring[after]), spacing_mm, [beside(i), beside(after)]);
                outline.at.push(a.mm());
                outline.at.extend(shares.map(|share| lerp(a.mm(), ring[after].mm(), share)));
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
