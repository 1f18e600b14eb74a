//! Regions of rings that are apart or cross: they are cut where they cross, and of the rings and arcs that are left, those
//! that part inside from outside make up the boundary (as Weiler & Atherton 1977, doi:10.1145/563858.563896, for windings of any number).
//!
//! Winding numbers are found once for each ring and then followed along it, changing by one at every crossing; so the cost
//! is that of finding the crossings. Where rings touch without crossing, the caller has to resolve them.

use std::cell::RefCell;

use super::arrange::{Arrangement, Rule};
use super::point::nearest_unit;
use super::region::{push_ring, surrounds};
use super::{Boxes, Point, Polygon, Region, Ring, ring_area};

/// Where a ring meets a crossing. The arc from here to the ring's next stop goes by the stop's index.
#[derive(Clone, Copy)]
struct Stop {
    /// The ring's edge, by its first vertex.
    edge: usize,
    /// Position on the edge, from 0 to 1.
    along: f64,
    crossing: usize,
    /// How the windings change here, going forward.
    step: [i32; 2],
    /// The ring's next stop.
    next: usize,
}

/// Windings of the first and the second rings on both sides of a ring, or of an arc of one.
#[derive(Clone, Copy, Default)]
struct Beside {
    left: [i32; 2],
    right: [i32; 2],
}

/// On which side of a ring, or of an arc, the inside is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    Left,
    Right,
    /// It does not part inside from outside.
    Neither,
}

impl Beside {
    fn side(&self, rule: Rule) -> Side {
        match (rule.inside(self.left), rule.inside(self.right)) {
            (true, false) => Side::Left,
            (false, true) => Side::Right,
            _ => Side::Neither,
        }
    }
}

/// Rings that are cut where they cross.
pub(super) struct Crossed<'a> {
    arrangement: &'a Arrangement,
    cuts: Cuts,
    tracing: Tracing,
}

/// Where rings are cut.
#[derive(Default)]
struct Cuts {
    /// In the order of the rings, and along them.
    stops: Vec<Stop>,
    /// The stops of each ring.
    owned: Vec<std::ops::Range<usize>>,
    /// The crossings.
    points: Vec<Point>,
    /// At the leftmost vertex of each ring.
    rings: Vec<Beside>,
    /// Along each arc.
    arcs: Vec<Beside>,
}

/// What the outlines are followed with.
#[derive(Default)]
struct Tracing {
    /// Of each arc.
    sides: Vec<Side>,
    /// For each crossing that the boundary passes, the arc by which it leaves and the crossing at that arc's end.
    leaving: Vec<Option<(usize, usize)>>,
    /// Whether the boundary enters a crossing.
    is_reached: Vec<bool>,
    done: Vec<bool>,
    outline: Ring,
}

thread_local! {
    /// What the last used, and the next uses again.
    static LAST: RefCell<(Cuts, Tracing)> = RefCell::default();
}

impl Drop for Crossed<'_> {
    fn drop(&mut self) {
        LAST.set((std::mem::take(&mut self.cuts), std::mem::take(&mut self.tracing)));
    }
}

impl<'a> Crossed<'a> {
    /// Cuts the rings where [`Arrangement::find_crossings`] found that they cross; `None` where some touch without crossing.
    /// O(n + c log c), as to find that out, and O(k log k) for k crossings.
    pub(super) fn new(arrangement: &'a Arrangement) -> Option<Self> {
        let (cuts, tracing) = LAST.take();
        let mut out = Self { arrangement, cuts, tracing };
        let Cuts { stops, owned, points, rings, arcs } = &mut out.cuts;
        stops.clear();
        owned.clear();
        points.clear();
        rings.clear();
        arcs.clear();
        arcs.resize(2 * arrangement.crossings().len(), Beside::default());
        out.cut(arrangement.crossings());
        for ring in 0..arrangement.spans().len() {
            out.find_windings(ring)?;
        }
        Some(out)
    }

    fn cut(&mut self, crossings: &[(usize, usize)]) {
        let (points, spans) = (self.arrangement.points(), self.arrangement.spans());
        let ring_of = |edge: usize| spans.partition_point(|&(_, end)| end <= edge);
        for (crossing, &(i, j)) in crossings.iter().enumerate() {
            let (a, c) = (points[i], points[j]);
            let (u, v) = (points[i + 1] - a, points[j + 1] - c);
            // Not zero, as they cross.
            let turn = u.cross(v);
            let along = |other: Point| (c - a).cross(other) as f64 / turn as f64;
            let at = |from: i32, by: i32| nearest_unit(f64::from(from) + along(v) * f64::from(by));
            self.cuts.points.push(Point::new(at(a.x, u.x), at(a.y, u.y)));
            // Where `j` points to the left of `i`, going along `i` leads from its left to its right.
            let sign = if turn > 0 { -1 } else { 1 };
            for (edge, along, other, sign) in [(i, along(v), j, sign), (j, along(u), i, -sign)] {
                let step = if self.arrangement.is_second(ring_of(other)) { [0, sign] } else { [sign, 0] };
                self.cuts.stops.push(Stop { edge, along, crossing, step, next: 0 });
            }
        }
        // Edges have 32-bit numbers, and the bits of positive numbers are in their order.
        self.cuts.stops.sort_unstable_by_key(|stop| {
            (stop.edge as u128) << 96 | u128::from(stop.along.to_bits()) << 32 | stop.crossing as u128
        });
        let mut from = 0;
        for &(_, end) in spans {
            let to = from + self.cuts.stops[from..].partition_point(|stop| stop.edge < end);
            for stop in from..to {
                self.cuts.stops[stop].next = if stop + 1 < to { stop + 1 } else { from };
            }
            self.cuts.owned.push(from..to);
            from = to;
        }
    }

    /// Finds the windings beside a ring; `None` if they do not add up.
    fn find_windings(&mut self, ring: usize) -> Option<()> {
        let (start, end) = self.arrangement.spans()[ring];
        let points = self.arrangement.points();
        // Left of its leftmost vertex the ring does not wind.
        let corner = self.arrangement.leftmost(ring);
        let before = points[if corner == start { end } else { corner } - 1];
        let turns_left = (points[corner] - before).cross(points[corner + 1] - points[corner]) > 0;
        let own = usize::from(self.arrangement.is_second(ring));
        let mut left = self.arrangement.winding_outside(ring, points[corner]);
        left[own] += i32::from(turns_left);
        let beside = |left: [i32; 2]| {
            let mut right = left;
            right[own] -= 1;
            Beside { left, right }
        };
        self.cuts.rings.push(beside(left));
        let owned = self.cuts.owned[ring].clone();
        if owned.is_empty() {
            return Some(());
        }
        let next = self.cuts.stops[owned.clone()].partition_point(|stop| stop.edge < corner);
        let first = left;
        for k in 0..owned.len() {
            let stop = owned.start + (next + k) % owned.len();
            let step = self.cuts.stops[stop].step;
            left = [left[0] + step[0], left[1] + step[1]];
            self.cuts.arcs[stop] = beside(left);
        }
        (left == first).then_some(())
    }

    /// The region that a rule leaves; `None` where its outlines meet at a crossing.
    pub(super) fn region(&mut self, rule: Rule) -> Option<Region> {
        let mut tracing = std::mem::take(&mut self.tracing);
        let outlines = self.outlines(rule, &mut tracing);
        self.tracing = tracing;
        outlines.map(nest)
    }

    fn outlines(&self, rule: Rule, tracing: &mut Tracing) -> Option<Vec<Ring>> {
        let mut outlines = self.whole_rings(rule);
        tracing.sides.clear();
        tracing.sides.extend(self.cuts.arcs.iter().map(|arc| arc.side(rule)));
        self.link(tracing)?;
        let Tracing { sides, leaving, done, outline, .. } = tracing;
        let crossings = self.cuts.points.len();
        done.clear();
        done.resize(crossings, false);
        for start in 0..crossings {
            outline.clear();
            let mut at = start;
            while !done[at]
                && let Some((arc, to)) = leaving[at]
            {
                done[at] = true;
                outline.push(self.cuts.points[at]);
                self.follow(arc, sides[arc], outline);
                at = to;
            }
            if outline.len() < 3 {
                continue;
            }
            // Rounding may have put a crossing on a vertex.
            let mut distinct = Ring::with_capacity(outline.len());
            push_ring(&mut distinct, outline);
            if distinct.len() > 2 {
                outlines.push(distinct);
            }
        }
        Some(outlines)
    }

    /// Rings that cross nothing, those that have inside on their right turned.
    fn whole_rings(&self, rule: Rule) -> Vec<Ring> {
        let mut out = Vec::new();
        for (ring, &(start, end)) in self.arrangement.spans().iter().enumerate() {
            if self.cuts.owned[ring].is_empty() {
                let points = self.arrangement.points()[start..end].iter().copied();
                match self.cuts.rings[ring].side(rule) {
                    Side::Left => out.push(points.collect()),
                    Side::Right => out.push(points.rev().collect()),
                    Side::Neither => {}
                }
            }
        }
        out
    }

    /// The crossings at which the boundary enters and leaves an arc, if it is part of it.
    fn ends(&self, arc: usize, side: Side) -> Option<[usize; 2]> {
        let [back, front] = [arc, self.cuts.stops[arc].next].map(|stop| self.cuts.stops[stop].crossing);
        match side {
            Side::Left => Some([back, front]),
            Side::Right => Some([front, back]),
            Side::Neither => None,
        }
    }

    /// Finds where the boundary leaves each crossing; `None` where it passes one twice.
    fn link(&self, tracing: &mut Tracing) -> Option<()> {
        let Tracing { sides, leaving, is_reached, .. } = tracing;
        let crossings = self.cuts.points.len();
        leaving.clear();
        leaving.resize(crossings, None);
        is_reached.clear();
        is_reached.resize(crossings, false);
        for (arc, &side) in sides.iter().enumerate() {
            if let Some([from, to]) = self.ends(arc, side)
                && (leaving[from].replace((arc, to)).is_some()
                    || std::mem::replace(&mut is_reached[to], true))
            {
                return None;
            }
        }
        let is_passed = leaving.iter().map(Option::is_some);
        is_passed.eq(is_reached.iter().copied()).then_some(())
    }

    /// Appends the vertices of an arc, with inside on the left.
    fn follow(&self, arc: usize, side: Side, outline: &mut Ring) {
        let next = self.cuts.stops[arc].next;
        let (from, to) = (self.cuts.stops[arc].edge, self.cuts.stops[next].edge);
        let points = self.arrangement.points();
        let at = outline.len();
        if next > arc {
            outline.extend_from_slice(&points[from + 1..to + 1]);
        } else {
            let ring = self.cuts.owned.partition_point(|owned| owned.end <= arc);
            let (start, end) = self.arrangement.spans()[ring];
            outline.extend_from_slice(&points[from + 1..end]);
            outline.extend_from_slice(&points[start..to + 1]);
        }
        if side == Side::Right {
            outline[at..].reverse();
        }
    }
}

/// Polygons of outlines that have inside on their left and do not cross.
fn nest(outlines: Vec<Ring>) -> Region {
    let (mut region, mut areas, mut holes) = (Region::default(), Vec::new(), Vec::new());
    for outline in outlines {
        let area = ring_area(&outline);
        if area > 0.0 {
            areas.push(area);
            region.polygons.push(Polygon { outer: outline, holes: Vec::new() });
        } else if area < 0.0 {
            holes.push(outline);
        }
    }
    let polygons = &mut region.polygons;
    let is_found = holes.is_empty() || polygons.len() == 1;
    let boxes = if is_found { Boxes::default() } else { Boxes::new(polygons.iter().map(Polygon::bounds)) };
    for hole in holes {
        let around = |p: Point| {
            let near = boxes.holding(p).into_iter().filter(|&i| surrounds(&polygons[i].outer, p));
            near.min_by(|&i, &j| areas[i].total_cmp(&areas[j]))
        };
        // Rounding may have put a vertex on the outline around.
        let home = if polygons.len() == 1 { Some(0) } else { hole.iter().find_map(|&p| around(p)) };
        if let Some(home) = home {
            polygons[home].holes.push(hole);
        }
    }
    region
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(x: i32, y: i32, side: i32) -> Ring {
        [(x, y), (x + side, y), (x + side, y + side), (x, y + side)].map(|(x, y)| Point::new(x, y)).to_vec()
    }

    fn region(rings: &[Ring], rule: Rule) -> Option<Region> {
        Arrangement::with(rings, [], |arrangement| {
            arrangement.find_crossings()?;
            Crossed::new(arrangement)?.region(rule)
        })
    }

    #[test]
    fn nesting_follows_the_rule() {
        let reversed = |mut ring: Ring| {
            ring.reverse();
            ring
        };
        // An outer ring, a hole, an island in the hole; and a stray ring that only the non-zero rule fills.
        let rings = [square(0, 0, 100), reversed(square(10, 10, 80)), square(20, 20, 10)];
        let stray = reversed(square(200, 0, 10));
        let all: Vec<Ring> = rings.iter().cloned().chain([stray]).collect();
        let positive = region(&all, Rule::Positive).unwrap();
        assert_eq!(positive.polygons.len(), 2);
        assert_eq!(positive.polygons[0].holes, [rings[1].clone()]);
        let non_zero = region(&all, Rule::NonZero).unwrap();
        assert_eq!(non_zero.polygons.len(), 3);
        assert!(non_zero.polygons.iter().all(|p| ring_area(&p.outer) > 0.0));
    }

    #[test]
    fn a_ring_inside_another_of_the_same_sense_vanishes() {
        let region = region(&[square(0, 0, 100), square(10, 10, 80)], Rule::NonZero).unwrap();
        assert_eq!(region.polygons, [Polygon { outer: square(0, 0, 100), holes: vec![] }]);
    }
}
