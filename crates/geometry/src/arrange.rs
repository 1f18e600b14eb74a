//! Sets of rings, and where they meet.
//!
//! Most rings that a slicer meets are simple already. A ring falls into chains that are monotone in x and y,
//! whose every part lies in the box of its two ends; so two chains are compared by halving, and chains are
//! paired by a sweep over their boxes. All decisions are exact.

use std::cell::RefCell;
use std::ops::ControlFlow;

use super::region::push_ring;
use super::sort::sort;
use super::{Bounds, Boxes, Point, Ring};

/// What counts as inside, by the winding numbers of the first and of the second rings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Rule {
    /// Non-zero for the first rings.
    NonZero,
    /// Positive (counter-clockwise) for the first rings.
    Positive,
    /// Non-zero for both.
    Both,
    /// Non-zero for either.
    Either,
    /// Non-zero for the first, zero for the second.
    FirstOnly,
}

impl Rule {
    pub(super) fn inside(self, [first, second]: [i32; 2]) -> bool {
        match self {
            Rule::NonZero => first != 0,
            Rule::Positive => first > 0,
            Rule::Both => first != 0 && second != 0,
            Rule::Either => first != 0 || second != 0,
            Rule::FirstOnly => first != 0 && second == 0,
        }
    }
}

/// How two edges that are not neighbours, or fold back over each other, meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Contact {
    /// Each parts the ends of the other.
    Cross,
    /// An end of one is on the other.
    Touch,
}

/// Chains of no more edges together are followed edge by edge.
const FEW: usize = 12;

/// Edges `first..last` of the closed-up points, monotone in both coordinates.
#[derive(Clone, Copy, Debug)]
struct Chain {
    first: usize,
    last: usize,
    ring: usize,
    bounds: Bounds,
}

/// The rings of an arrangement, split into monotone chains.
#[derive(Default)]
pub(super) struct Arrangement {
    /// How many of the rings are first ones.
    firsts: usize,
    /// All rings, each with its first point repeated at the end.
    points: Vec<Point>,
    /// First and last index of each ring in `points`.
    spans: Vec<(usize, usize)>,
    /// Chains of ring `i` are `chains[owned[i]..owned[i + 1]]`.
    chains: Vec<Chain>,
    owned: Vec<usize>,
    boxes: Vec<Bounds>,
    /// The same, where there are many.
    tree: Option<Boxes>,
    leftmost: Vec<usize>,
    /// Chains in the order of the sweep, while it lasts.
    order: Vec<Swept>,
    crossings: Vec<(usize, usize)>,
}

/// A chain that is swept: where it begins along the axis, its number, where it ends, and where it begins and ends across.
type Swept = (i32, u32, i32, [i32; 2]);

thread_local! {
    /// The last arrangement, whose buffers the next one uses.
    static LAST: RefCell<Arrangement> = RefCell::default();
}

/// The boxes of more rings are looked up in a tree.
const MANY: usize = 64;

impl Arrangement {
    /// What a function makes of first and second rings, split. Rings of fewer than three points, of equal neighbours one, are left
    /// out.
    pub(super) fn with<'a, T>(
        first: impl IntoIterator<Item = &'a Ring>,
        second: impl IntoIterator<Item = &'a Ring>,
        work: impl FnOnce(&mut Self) -> T,
    ) -> T {
        let mut arrangement = LAST.take();
        arrangement.split(first, second);
        let result = work(&mut arrangement);
        LAST.set(arrangement);
        result
    }

    /// Replaces all rings.
    fn split<'a>(
        &mut self,
        first: impl IntoIterator<Item = &'a Ring>,
        second: impl IntoIterator<Item = &'a Ring>,
    ) {
        let Self { firsts, points, spans, chains, owned, boxes, tree, leftmost, .. } = self;
        points.clear();
        spans.clear();
        let mut add = |ring: &Ring| {
            let start = points.len();
            push_ring(points, ring);
            let end = points.len();
            if end - start > 2 {
                points.push(points[start]);
                spans.push((start, end));
            } else {
                points.truncate(start);
            }
            spans.len()
        };
        *firsts = first.into_iter().map(&mut add).last().unwrap_or(0);
        second.into_iter().for_each(|ring| _ = add(ring));
        chains.clear();
        owned.clear();
        boxes.clear();
        leftmost.clear();
        owned.push(0);
        for (index, &(start, end)) in spans.iter().enumerate() {
            let (mut first, mut sense) = (start, (0, 0));
            let mut least = start;
            let mut whole: Option<Bounds> = None;
            let mut emit = |first: usize, last: usize| {
                let bounds = Bounds::spanned(points[first], points[last]);
                whole = Some(whole.map_or(bounds, |w| w.joined(&bounds)));
                chains.push(Chain { first, last, ring: index, bounds });
            };
            for i in start..end {
                if points[i] < points[least] {
                    least = i;
                }
                let step =
                    ((points[i + 1].x - points[i].x).signum(), (points[i + 1].y - points[i].y).signum());
                if step.0 * sense.0 < 0 || step.1 * sense.1 < 0 {
                    emit(first, i);
                    (first, sense) = (i, step);
                } else {
                    if sense.0 == 0 {
                        sense.0 = step.0;
                    }
                    if sense.1 == 0 {
                        sense.1 = step.1;
                    }
                }
            }
            emit(first, end);
            leftmost.push(least);
            owned.push(chains.len());
            boxes.push(whole.unwrap_or(Bounds::spanned(points[start], points[start])));
        }
        *tree = (boxes.len() > MANY).then(|| Boxes::new(boxes.iter().copied()));
    }

    /// Finds out where edges cross; `None` where edges touch otherwise than neighbours in a ring at their common vertex.
    /// O(n + c log c) for n vertices in c chains when chains are mostly apart, and O(1) for each pair.
    pub(super) fn find_crossings(&mut self) -> Option<()> {
        let (mut order, mut pairs) = (std::mem::take(&mut self.order), std::mem::take(&mut self.crossings));
        pairs.clear();
        let end = self.meetings(&mut order, &mut |i, j, contact| {
            if contact == Contact::Touch {
                return ControlFlow::Break(());
            }
            pairs.push((i, j));
            ControlFlow::Continue(())
        });
        (self.order, self.crossings) = (order, pairs);
        end.is_continue().then_some(())
    }

    /// Pairs of edges that cross, each by its first vertex in [`Self::points`], where [`Self::find_crossings`] found nothing else.
    pub(super) fn crossings(&self) -> &[(usize, usize)] {
        &self.crossings
    }

    /// Calls a function for every two edges that meet elsewhere than at a vertex between neighbours. The order of the sweep replaces
    /// the contents of `order`.
    fn meetings(
        &self,
        order: &mut Vec<Swept>,
        see: &mut impl FnMut(usize, usize, Contact) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        // Sweep along the axis on which the chains are shorter.
        let whole = self.boxes.iter().copied().reduce(|a, b| a.joined(&b)).unwrap_or_default();
        let sides = |b: &Bounds| b.size().map(|side| side as f64);
        let sums = self.chains.iter().map(|chain| sides(&chain.bounds));
        let [width, height] = sums.fold([0.0; 2], |sum, side| [sum[0] + side[0], sum[1] + side[1]]);
        let [across, up] = sides(&whole).map(|side| side.max(1.0));
        let along_x = width / across <= height / up;
        let swept = |(i, Chain { bounds: Bounds { min, max }, .. }): (usize, &Chain)| match along_x {
            true => (min.x, i as u32, max.x, [min.y, max.y]),
            false => (min.y, i as u32, max.y, [min.x, max.x]),
        };
        order.clear();
        order.extend(self.chains.iter().enumerate().map(swept));
        sort(order, |&(begin, chain, ..)| (begin, chain));
        for (i, &(_, a, end, [low, high])) in order.iter().enumerate() {
            for &(_, b, _, [from, to]) in order[i + 1..].iter().take_while(|b| b.0 <= end) {
                if from > high || to < low {
                    continue;
                }
                let (a, b) = (&self.chains[a as usize], &self.chains[b as usize]);
                if !self.only_joins(a, b) && !self.only_joins(b, a) {
                    self.meetings_of(a, b, see)?;
                }
            }
        }
        ControlFlow::Continue(())
    }

    /// Whether a chain surely meets the one after it at their common vertex only: they lie on different sides of a level or
    /// upright line through it, and one of them leaves that line at once.
    fn only_joins(&self, a: &Chain, b: &Chain) -> bool {
        let closes = || (b.first, a.last) == self.spans[a.ring];
        if a.ring != b.ring || (a.last != b.first && !closes()) {
            return false;
        }
        let (before, at, after) = (self.points[a.last - 1], self.points[a.last], self.points[b.first + 1]);
        let (from, to) = (a.bounds, b.bounds);
        let level = from.min.y.max(to.min.y) == from.max.y.min(to.max.y);
        let upright = from.min.x.max(to.min.x) == from.max.x.min(to.max.x);
        level && (before.y != at.y || after.y != at.y) || upright && (before.x != at.x || after.x != at.x)
    }

    /// [`Self::meetings`] of two chains whose boxes touch.
    fn meetings_of(
        &self,
        a: &Chain,
        b: &Chain,
        see: &mut impl FnMut(usize, usize, Contact) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let (length_a, length_b) = (a.last - a.first, b.last - b.first);
        if length_a == 1 && length_b == 1 {
            return match self.contact(a.first, b.first, a.ring) {
                Some(contact) => see(a.first, b.first, contact),
                None => ControlFlow::Continue(()),
            };
        }
        if length_a + length_b <= FEW {
            let [width, height] = a.bounds.size();
            return match width >= height {
                true => self.meetings_in_step::<true>(a, b, see),
                false => self.meetings_in_step::<false>(a, b, see),
            };
        }
        let longer = if length_a >= length_b { a } else { b };
        let half = usize::midpoint(longer.first, longer.last);
        for (first, last) in [(longer.first, half), (half, longer.last)] {
            let bounds = Bounds::spanned(self.points[first], self.points[last]);
            let part = Chain { first, last, bounds, ring: longer.ring };
            if length_a >= length_b {
                if bounds.touches(&b.bounds) {
                    self.meetings_of(&part, b, see)?;
                }
            } else if bounds.touches(&a.bounds) {
                self.meetings_of(a, &part, see)?;
            }
        }
        ControlFlow::Continue(())
    }

    /// [`Self::meetings`] of two chains of few edges, followed at the same pace along X or along Y.
    fn meetings_in_step<const ALONG_X: bool>(
        &self,
        a: &Chain,
        b: &Chain,
        see: &mut impl FnMut(usize, usize, Contact) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let at = |point: usize| {
            let Point { x, y } = self.points[point];
            if ALONG_X { [x, y] } else { [y, x] }
        };
        // Where an edge begins and ends along the axis, and across.
        let spans = |edge: usize| {
            let ([from, low], [to, high]) = (at(edge), at(edge + 1));
            [(from.min(to), from.max(to)), (low.min(high), low.max(high))]
        };
        let ascends = |chain: &Chain| at(chain.first)[0] <= at(chain.last)[0];
        let (a_ascends, b_ascends) = (ascends(a), ascends(b));
        let edge = |chain: &Chain, ascends: bool, k: usize| {
            if ascends { chain.first + k } else { chain.last - 1 - k }
        };
        let count = b.last - b.first;
        let mut passed = 0;
        let [low, high] = [b.bounds.min, b.bounds.max].map(|p| if ALONG_X { [p.x, p.y] } else { [p.y, p.x] });
        for i in (0..a.last - a.first).map(|k| edge(a, a_ascends, k)) {
            let [along, across] = spans(i);
            if along.0 > high[0] {
                break;
            }
            if along.1 < low[0] || across.1 < low[1] || across.0 > high[1] {
                continue;
            }
            while passed < count && spans(edge(b, b_ascends, passed))[0].1 < along.0 {
                passed += 1;
            }
            for j in (passed..count).map(|k| edge(b, b_ascends, k)) {
                let [beside, over] = spans(j);
                if beside.0 > along.1 {
                    break;
                }
                if over.0 <= across.1
                    && across.0 <= over.1
                    && let Some(contact) = self.contact(i, j, a.ring)
                {
                    see(i, j, contact)?;
                }
            }
        }
        ControlFlow::Continue(())
    }

    fn contact(&self, i: usize, j: usize, ring: usize) -> Option<Contact> {
        let (a, b, c, d) = (self.points[i], self.points[i + 1], self.points[j], self.points[j + 1]);
        let (start, end) = self.spans[ring];
        let follows = |i: usize, j: usize| i + 1 == j || (j == start && i + 1 == end);
        let folds = |from: Point, at: Point, to: Point| {
            (from - at).cross(to - at) == 0 && (from - at).dot(to - at) > 0
        };
        if follows(i, j) {
            return folds(a, b, d).then_some(Contact::Touch);
        }
        if follows(j, i) {
            return folds(c, d, b).then_some(Contact::Touch);
        }
        let side = |p: Point, q: Point, r: Point| (q - p).cross(r - p).signum();
        match (side(a, b, c) * side(a, b, d), side(c, d, a) * side(c, d, b)) {
            (-1, -1) => Some(Contact::Cross),
            (..=0, ..=0) => Some(Contact::Touch),
            _ => None,
        }
    }

    /// All rings, each with its first point repeated at the end.
    pub(super) fn points(&self) -> &[Point] {
        &self.points
    }

    /// First and last index of each ring in [`Self::points`], first rings first.
    pub(super) fn spans(&self) -> &[(usize, usize)] {
        &self.spans
    }

    /// Whether a ring is one of the second.
    pub(super) fn is_second(&self, ring: usize) -> bool {
        ring >= self.firsts
    }

    /// The leftmost vertex of a ring, of those the lowest, by its index in [`Self::points`].
    pub(super) fn leftmost(&self, ring: usize) -> usize {
        self.leftmost[ring]
    }

    /// Winding numbers of the first and the second rings but `own` around a point, which none of them may touch.
    pub(super) fn winding_outside(&self, own: usize, p: Point) -> [i32; 2] {
        let mut sum = [0, 0];
        let add = |ring: usize| {
            if ring != own {
                sum[usize::from(self.is_second(ring))] += self.winding(ring, p);
            }
        };
        match &self.tree {
            Some(tree) => tree.holding(p).into_iter().for_each(add),
            None => (0..self.boxes.len()).filter(|&ring| self.boxes[ring].holds(p)).for_each(add),
        }
        sum
    }

    /// Winding number of a ring around a point that is not on it.
    fn winding(&self, ring: usize, p: Point) -> i32 {
        if !self.boxes[ring].holds(p) {
            return 0;
        }
        self.chains[self.owned[ring]..self.owned[ring + 1]]
            .iter()
            .map(|chain| {
                let up = self.points[chain.first].y <= p.y;
                if up == (self.points[chain.last].y <= p.y) || chain.bounds.max.x < p.x {
                    return 0;
                }
                let run = &self.points[chain.first..=chain.last];
                let after = run.partition_point(|q| (q.y <= p.y) == up);
                let (a, b) = (run[after - 1], run[after]);
                let side = (b - a).cross(p - a);
                i32::from(up && side > 0) - i32::from(!up && side < 0)
            })
            .sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring(points: &[(i32, i32)]) -> Ring {
        points.iter().map(|&(x, y)| Point::new(x, y)).collect()
    }

    fn square(x: i32, y: i32, side: i32) -> Ring {
        ring(&[(x, y), (x + side, y), (x + side, y + side), (x, y + side)])
    }

    fn is_simple(rings: &[Ring]) -> bool {
        Arrangement::with(rings, [], |arrangement| {
            arrangement.find_crossings().is_some() && arrangement.crossings().is_empty()
        })
    }

    #[test]
    fn touching_rings_are_not_simple() {
        assert!(is_simple(&[square(0, 0, 10), square(11, 0, 10)]));
        assert!(!is_simple(&[square(0, 0, 10), square(10, 3, 10)]));
        assert!(!is_simple(&[square(0, 0, 10), square(10, 10, 10)]));
        assert!(is_simple(&[square(0, 0, 10), square(1, 1, 8)]));
        assert!(!is_simple(&[ring(&[(0, 0), (10, 10), (10, 0), (0, 10)])]));
        assert!(!is_simple(&[ring(&[(0, 0), (10, 0), (5, 0), (5, 5)])]));
    }
}
