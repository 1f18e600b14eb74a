//! Rings that touch, moved by less than half a unit so that they are apart or cross, and rounded back.
//!
//! Which way they move decides what touching means: rings that move outwards merge, others part. This is symbolic perturbation
//! (Edelsbrunner & Mücke 1990, doi:10.1145/77635.77639) in numbers: coordinates become finer, and whatever does not cross comes
//! back as it was.

use super::arrange::{Arrangement, Rule};
use super::crossed::Crossed;
use super::point::nearest_unit;
use super::{Bounds, Point, Polygon, Region, Ring};

/// Rings move within so many finer units of the origin that products fit 64 bits.
const REACH: u32 = 29;

/// Finer units to a unit, as powers of two: the least that make a difference, and as many as do any good.
const FINER: std::ops::RangeInclusive<u32> = 4..=8;

/// No vertex moves farther, in units: rounded, it is where it was.
const FARTHEST: f64 = 0.46;

/// How often rings are moved, each time otherwise.
const ROUNDS: u32 = 2;

/// Multiplied with, numbers of vertices spread over a word: 2³² over the golden ratio.
const SPREAD: u32 = 0x9E37_79B1;

/// How far rings move to their right, which is outwards, in units; each vertex otherwise, so that edges in one line do not stay in
/// one. Negative: to their left.
#[derive(Clone, Copy)]
struct Shift {
    least: f64,
    most: f64,
}

impl Shift {
    fn of_vertex(self, number: usize, round: u32) -> f64 {
        let spread = (number as u32 ^ round << 24).wrapping_mul(SPREAD);
        self.least + (self.most - self.least) * f64::from(spread >> 16) / 65_536.0
    }
}

/// How far the first and the second rings move. What is equal in both moves to different places.
fn shifts(rule: Rule) -> [Shift; 2] {
    let shift = |least, most| Shift { least, most };
    match rule {
        Rule::NonZero => [shift(0.1, 0.42); 2],
        Rule::Positive => [shift(-0.1, -0.42); 2],
        Rule::Either => [shift(0.1, 0.22), shift(0.3, 0.42)],
        Rule::Both => [shift(-0.1, -0.22), shift(-0.3, -0.42)],
        Rule::FirstOnly => [shift(-0.1, -0.42), shift(0.1, 0.42)],
    }
}

/// The region that a rule leaves of rings that touch; `None` where moving them does not help, or they reach too far.
pub(super) fn region(arrangement: &Arrangement, rule: Rule) -> Option<Region> {
    let bounds = Bounds::of(arrangement.points().iter().copied())?;
    let [width, height] = bounds.size();
    let finer = REACH.checked_sub(width.max(height).max(1).ilog2())?.min(*FINER.end());
    if !FINER.contains(&finer) {
        return None;
    }
    let [x, y] =
        [(bounds.min.x, bounds.max.x), (bounds.min.y, bounds.max.y)].map(|(a, b)| i32::midpoint(a, b));
    let frame = Frame { origin: Point::new(x, y), finer };
    (0..ROUNDS).find_map(|round| frame.region(arrangement, rule, round))
}

/// Where finer coordinates begin, and how many of them are a unit, as a power of two.
#[derive(Clone, Copy)]
struct Frame {
    origin: Point,
    finer: u32,
}

impl Frame {
    fn region(self, arrangement: &Arrangement, rule: Rule, round: u32) -> Option<Region> {
        let shifts = shifts(rule);
        let (mut first, mut second) = (Vec::new(), Vec::new());
        for (ring, &(start, end)) in arrangement.spans().iter().enumerate() {
            let is_second = arrangement.is_second(ring);
            let by = |vertex: usize| shifts[usize::from(is_second)].of_vertex(start + vertex, round);
            let moved = self.moved(&arrangement.points()[start..end], by);
            if is_second { &mut second } else { &mut first }.push(moved);
        }
        let region = Arrangement::with(&first, &second, |finer| {
            finer.find_crossings()?;
            Crossed::new(finer)?.region(rule)
        })?;
        let rounded = |ring: &Ring| cleaned(ring.iter().map(|&p| self.coarser(p)));
        let polygons = region.polygons.iter().filter_map(|polygon| {
            let outer = rounded(&polygon.outer);
            let holes = polygon.holes.iter().map(rounded).filter(|hole| !hole.is_empty());
            (!outer.is_empty()).then(|| Polygon { outer, holes: holes.collect() })
        });
        Some(Region { polygons: polygons.collect() })
    }

    /// A ring in finer units, each vertex moved to the right of the edges at it.
    fn moved(self, ring: &[Point], by: impl Fn(usize) -> f64) -> Ring {
        let direction = |from: Point, to: Point| {
            let (x, y) = (f64::from(to.x) - f64::from(from.x), f64::from(to.y) - f64::from(from.y));
            let length = (x * x + y * y).sqrt();
            [x / length, y / length]
        };
        let n = ring.len();
        let scale = f64::from(1 << self.finer);
        let mut before = direction(ring[n - 1], ring[0]);
        let vertex = |i: usize| {
            let after = direction(ring[i], ring[if i + 1 == n { 0 } else { i + 1 }]);
            let open = 1.0 + before[0] * after[0] + before[1] * after[1];
            // Where the ring turns back, its tip moves along it.
            let [x, y] = match open > 1e-6 {
                true => [(before[1] + after[1]) / open, -(before[0] + after[0]) / open],
                false => before,
            };
            before = after;
            let by = by(i);
            let least = (x * x + y * y).sqrt() * by.abs();
            let by = scale * if least > FARTHEST { by * FARTHEST / least } else { by };
            let at = ring[i] - self.origin;
            Point::new(
                (at.x << self.finer) + nearest_unit(by * x),
                (at.y << self.finer) + nearest_unit(by * y),
            )
        };
        (0..n).map(vertex).collect()
    }

    /// The nearest unit of a point in finer ones.
    fn coarser(self, p: Point) -> Point {
        let half = 1 << (self.finer - 1);
        Point::new((p.x + half) >> self.finer, (p.y + half) >> self.finer) + self.origin
    }
}

/// A ring without equal neighbours, vertices on straight lines and spikes; empty if nothing is left.
fn cleaned(points: impl Iterator<Item = Point>) -> Ring {
    let mut ring = Ring::new();
    for p in points {
        add(&mut ring, p);
    }
    // The same where the ring closes.
    let mut first = 0;
    while ring.len() - first > 2 {
        let n = ring.len();
        if ring[n - 1] == ring[first] || is_level(ring[n - 2], ring[n - 1], ring[first]) {
            ring.pop();
        } else if is_level(ring[n - 1], ring[first], ring[first + 1]) {
            first += 1;
        } else {
            break;
        }
    }
    if ring.len() - first > 2 { ring.split_off(first) } else { Ring::new() }
}

fn add(ring: &mut Ring, p: Point) {
    while let [.., a, b] = ring[..]
        && b != p
        && is_level(a, b, p)
    {
        ring.pop();
    }
    if ring.last() != Some(&p) {
        ring.push(p);
    }
}

/// Whether a vertex is on the straight line of its neighbours, between them or at the tip of a spike.
fn is_level(a: Point, b: Point, c: Point) -> bool {
    (b - a).cross(c - b) == 0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ring_area;

    fn square(x: i32, y: i32, side: i32) -> Ring {
        [(x, y), (x + side, y), (x + side, y + side), (x, y + side)].map(|(x, y)| Point::new(x, y)).to_vec()
    }

    fn of(first: &[Ring], second: &[Ring], rule: Rule) -> Vec<f64> {
        let region = Arrangement::with(first, second, |arrangement| region(arrangement, rule));
        let region = region.expect("they are parted");
        let unit2 = 1e-10;
        region
            .polygons
            .iter()
            .map(|p| (p.rings().map(|ring| ring_area(ring)).sum::<f64>() / unit2).round())
            .collect()
    }

    #[test]
    fn squares_side_by_side_have_nothing_in_common_and_merge() {
        let (a, b) = ([square(0, 0, 1000)], [square(1000, 0, 1000)]);
        assert_eq!(of(&a, &b, Rule::Both), [0.0; 0]);
        assert_eq!(of(&a, &b, Rule::Either), [2e6]);
        assert_eq!(of(&a, &b, Rule::FirstOnly), [1e6]);
    }

    #[test]
    fn a_square_in_the_corner_of_another_shares_edges_with_it() {
        let (a, b) = ([square(0, 0, 1000)], [square(0, 0, 600)]);
        assert_eq!(of(&a, &b, Rule::Both), [36e4]);
        assert_eq!(of(&a, &b, Rule::Either), [1e6]);
        assert_eq!(of(&a, &b, Rule::FirstOnly), [64e4]);
        assert_eq!(of(&b, &a, Rule::FirstOnly), [0.0; 0]);
        assert_eq!(of(&a, &a, Rule::Both), [1e6]);
    }

    #[test]
    fn rings_in_one_line_are_united() {
        let rings = [square(0, 0, 1000), square(500, 0, 1000), square(1500, 0, 1000)];
        assert_eq!(of(&rings, &[], Rule::NonZero), [25e5]);
    }
}
