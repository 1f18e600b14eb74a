//! Chains the layers of a print: each begins where the last one ended.
//!
//! Chunks of layers can be solved in parallel without changing the result: their length depends on the number of
//! layers only, each is solved from a free start, and then the layers around each join are solved again with both
//! ends known.

use std::ops::Range;
use std::slice;

use super::layer::{LayerProblem, PathOrder, PathVisit, ends_on_path};
use super::options::{OrderSettings, SeamPosition};
use super::seam::{Pins, enter_nearest};
use super::stack::Stack;
use super::straight_on::{Corners, StraightOn};
use crate::toolpath::LayerPaths;
use geometry::{Point, Router};
use ordering::{
    Cost, DetourRule, Detours, Effort, Known, LinkKind, Nearest, Problem, Sequence, Strategy, Watch, bound,
    first_points, strategy,
};

/// Paths of which the cheapest order is sought, at most.
const CLOSED_PATHS: usize = 40;

/// Layers of few paths, each alone.
fn alone(layers: &[LayerPaths]) -> Vec<Range<usize>> {
    (0..layers.len()).filter(|&i| layers[i].paths.len() <= CLOSED_PATHS).map(|i| i..i + 1).collect()
}

/// As many neighbouring layers as have few paths together, two at least; each group begins in the middle of the one before.
fn neighbours(layers: &[LayerPaths]) -> Vec<Range<usize>> {
    let (mut groups, mut first) = (Vec::new(), 0);
    while first < layers.len() {
        let sums = layers[first..].iter().scan(0, |sum, layer| {
            *sum += layer.paths.len();
            Some(*sum)
        });
        let count = sums.take_while(|&sum| sum <= CLOSED_PATHS).count();
        if count > 1 {
            groups.push(first..first + count);
        }
        first += count.div_ceil(2).max(1);
    }
    groups
}

/// Layers per chunk for a print of so many layers: enough chunks to keep every core busy, and not so
/// short that solving heads twice costs much.
pub fn chunk_len(layers: usize) -> usize {
    let few = layers.div_ceil(4).clamp(4, 16);
    (layers / 64).clamp(few, 32)
}

/// How the layers of a print are ordered.
#[derive(Clone, Debug)]
pub struct Chain {
    /// Strategy, scope, effort, whether and how layers are chained.
    pub settings: OrderSettings,
    /// What is minimised.
    pub cost: Cost,
    /// How travels are led inside of islands; `None`: straight.
    pub detours: Option<DetourRule>,
    /// What the corners between beads and travels cost; `None`: as much as stops, or entries are not free.
    pub corners: Option<Corners>,
    /// Only `nearest` matters here; the other rules arrive as [`Pins`].
    pub seam: SeamPosition,
    /// Where the nozzle is before the first layer, if that is known.
    pub origin: Option<Point>,
}

impl Chain {
    /// Orders consecutive layers, the first of them from `start` (`None`: from anywhere), each of the others from
    /// where the one before ended. `pins[i]` belongs to `layers[i]`. Entries of loops in the result are
    /// indices into their path's points.
    pub fn solve_chunk(
        &self,
        layers: &[LayerPaths],
        pins: &[Pins],
        start: Option<Point>,
        watch: Watch<'_>,
    ) -> Vec<PathOrder> {
        self.solve_between(layers, pins, (start, None), &self.routers(layers), None, watch)
    }

    /// The routers of the layers; none where travels go straight.
    fn routers<'l>(&self, layers: &'l [LayerPaths]) -> Vec<Router<'l>> {
        let router = |rule: DetourRule| {
            let (width_mm, most_mm) = (rule.wall_width_mm, rule.max_mm);
            layers.iter().map(move |layer| Router::new(&layer.outline, width_mm, most_mm))
        };
        self.detours.map(router).into_iter().flatten().collect()
    }

    /// Whether layers are solved as one problem.
    fn is_together(&self) -> bool {
        // A distance between layers is kept by moving where each begins, which the others must know.
        let apart = self.settings.layer_distance.0 > 0.0;
        self.settings.chain && !apart && strategy(self.settings.strategy).looks_ahead()
    }

    /// Orders consecutive layers from one position to another, where these are known: anew, or, where they are
    /// solved as one problem, from what was `solved` before.
    fn solve_between(
        &self,
        layers: &[LayerPaths],
        pins: &[Pins],
        (start, end): (Option<Point>, Option<Point>),
        routers: &[Router],
        solved: Option<&[PathOrder]>,
        watch: Watch<'_>,
    ) -> Vec<PathOrder> {
        if self.is_together() {
            let mut orders = self.solve_together(layers, pins, (start, end), routers, solved, watch);
            self.close(layers, pins, (start, end), routers, &mut orders, watch);
            return orders;
        }
        let mut at = start;
        let mut sequences = Vec::with_capacity(layers.len());
        for (i, (layer, pins)) in layers.iter().zip(pins).enumerate() {
            let end = end.filter(|_| i + 1 == layers.len());
            let sequence = self.solve_layer(layer, pins, (at, end), routers.get(i), watch);
            if let Some(&last) = sequence.last() {
                at = Some(ends_on_path(layer, last).1);
            }
            sequences.push(sequence);
        }
        sequences
    }

    /// Orders consecutive layers as one problem, so that each ends where it suits the next.
    fn solve_together(
        &self,
        layers: &[LayerPaths],
        pins: &[Pins],
        (start, end): (Option<Point>, Option<Point>),
        routers: &[Router],
        solved: Option<&[PathOrder]>,
        watch: Watch<'_>,
    ) -> Vec<PathOrder> {
        let stack = Stack::new(layers, pins, self.settings.scope, (start.or(self.origin), end));
        let before = solved.map(|solved| stack.sequence(solved));
        let mut solved = self.solve(&stack.problem, layers, routers, before, watch);
        if self.seam == SeamPosition::Nearest {
            enter_nearest(&stack.problem, &mut solved);
        }
        stack.orders(solved)
    }

    /// With high effort, small layers take the cheapest order between the ends of their neighbours, first one after the other, then
    /// several together, so that each ends where it suits the next.
    fn close(
        &self,
        layers: &[LayerPaths],
        pins: &[Pins],
        (start, end): (Option<Point>, Option<Point>),
        routers: &[Router],
        orders: &mut [PathOrder],
        watch: Watch<'_>,
    ) {
        if self.settings.effort != Effort::High || self.seam == SeamPosition::Nearest {
            return;
        }
        for windows in [alone(layers), neighbours(layers)] {
            for window in windows {
                watch.look();
                self.close_window(layers, pins, (start, end), window, routers, orders);
            }
        }
    }

    /// The cheapest order of some layers between the ends of their neighbours, where relaxed walks find one (on straight links) and
    /// it costs less.
    fn close_window(
        &self,
        layers: &[LayerPaths],
        pins: &[Pins],
        (start, end): (Option<Point>, Option<Point>),
        window: Range<usize>,
        routers: &[Router],
        orders: &mut [PathOrder],
    ) {
        let last = |(order, layer): (&PathOrder, _)| Some(ends_on_path(layer, *order.last()?).1);
        let begin = |(order, layer): (&PathOrder, _)| Some(ends_on_path(layer, *order.first()?).0);
        let at = orders[..window.start].iter().zip(layers).rev().find_map(last).or(start).or(self.origin);
        let next = orders[window.end..].iter().zip(&layers[window.end..]).find_map(begin).or(end);
        let (layers, routers) = (&layers[window.clone()], routers.get(window.clone()).unwrap_or_default());
        let stack = Stack::new(layers, &pins[window.clone()], self.settings.scope, (at, next));
        if stack.problem.items.len() < 2 {
            return;
        }
        let solved = stack.sequence(&orders[window.clone()]);
        let proof = bound::by_walks(&stack.problem, &solved, &self.cost, Effort::Normal);
        let Some(better) = proof.and_then(|proof| proof.better) else { return };
        let better = stack.orders(better);
        let cost = |orders: &[PathOrder]| self.cost_between(layers, orders, at, next, routers);
        if cost(&better) < cost(&orders[window.clone()]) {
            orders[window].clone_from_slice(&better);
        }
    }

    /// Solves the problem of consecutive layers, anew or from what was found before.
    fn solve(
        &self,
        problem: &Problem,
        layers: &[LayerPaths],
        routers: &[Router],
        solved: Option<Sequence>,
        watch: Watch<'_>,
    ) -> Sequence {
        let detours = self.detours.map(|rule| {
            let items = layers.iter().map(|layer| layer.paths.len());
            Detours::new(rule, self.cost, items, routers)
        });
        let known = Known { detours: detours.as_ref(), solved, watch, ..Known::default() };
        strategy(self.settings.strategy).solve_knowing(problem, &self.cost, self.settings.effort, known)
    }

    /// The order of a layer with the entries that let the nozzle go straight on, where that is looked for. Where the layer begins
    /// and ends stays.
    pub fn straight_on(&self, layer: &LayerPaths, order: PathOrder) -> PathOrder {
        match self.corners {
            Some(corners) => StraightOn { corners, detours: self.detours }.enter(layer, order),
            None => order,
        }
    }

    /// How many layers of the chunk before take part where two chunks are joined.
    pub fn overlap(&self) -> usize {
        usize::from(self.is_together())
    }

    /// Orders the layers around a join again: the last [`overlap`](Self::overlap) of a chunk and the first of the next, now
    /// that it is known where the layer before ended (`start`) and where the layer above begins (`next` and its sequence;
    /// `None` if there is none in this chunk). Returns the better of the old and the new sequences, counting the links at
    /// both ends.
    pub fn resolve_join(
        &self,
        layers: &[LayerPaths],
        pins: &[Pins],
        solved: Vec<PathOrder>,
        next: Option<(&LayerPaths, &[PathVisit])>,
        start: Option<Point>,
        watch: Watch<'_>,
    ) -> Vec<PathOrder> {
        if !self.settings.chain {
            return solved;
        }
        let end = next.and_then(|(layer, sequence)| Some(ends_on_path(layer, *sequence.first()?).0));
        let routers = self.routers(layers);
        let again = self.solve_between(layers, pins, (start, end), &routers, Some(&solved), watch);
        let too_near = |sequences: &[PathOrder]| {
            let first = sequences[0].first().map(|&visit| ends_on_path(&layers[0], visit).0);
            matches!((start, first), (Some(a), Some(b)) if a.distance_mm(b) < self.settings.layer_distance.0)
        };
        let key = |sequences: &[PathOrder]| {
            (too_near(sequences), self.cost_between(layers, sequences, start, end, &routers))
        };
        if key(&solved) < key(&again) { solved } else { again }
    }

    /// Cost of the links of layers, with those from `start` and to `end` where they are known.
    fn cost_between(
        &self,
        layers: &[LayerPaths],
        sequences: &[PathOrder],
        start: Option<Point>,
        end: Option<Point>,
        routers: &[Router],
    ) -> f64 {
        let (mut at, mut total) = (start, 0.0);
        for (i, (layer, sequence)) in layers.iter().zip(sequences).enumerate() {
            let mut island = None;
            let router = self.detours.zip(routers.get(i));
            for &visit in sequence {
                let (enter, leave) = ends_on_path(layer, visit);
                let climbs = island.is_none();
                let here = Some(layer.paths[visit.path as usize].island);
                total += match (at, router) {
                    (Some(from), Some((rule, router))) if here == island => {
                        rule.cost(router, &self.cost, [from.mm(), enter.mm()], climbs)
                    }
                    (Some(from), _) => {
                        self.cost.of(from.distance_mm(enter), LinkKind { inside: here == island, climbs })
                    }
                    (None, _) => 0.0,
                };
                (at, island) = (Some(leave), here);
            }
        }
        total + at.zip(end).map_or(0.0, |(from, to)| self.cost.of(from.distance_mm(to), LinkKind::UP))
    }

    fn solve_layer(
        &self,
        paths: &LayerPaths,
        pins: &Pins,
        (start, end): (Option<Point>, Option<Point>),
        router: Option<&Router>,
        watch: Watch<'_>,
    ) -> PathOrder {
        let mut layer = LayerProblem::new(paths, pins, self.settings.scope);
        (layer.problem.start, layer.problem.end) =
            if self.settings.chain { (start.or(self.origin), end) } else { (self.origin, None) };
        let solve = |problem: &Problem| {
            let routers = router.map(slice::from_ref).unwrap_or_default();
            self.solve(problem, slice::from_ref(paths), routers, None, watch)
        };
        let mut sequence = self.solve_apart(&mut layer.problem, start, solve);
        if self.seam == SeamPosition::Nearest {
            enter_nearest(&layer.problem, &mut sequence);
        }
        layer.on_paths(sequence)
    }

    /// Solves a problem; a walk that would begin too near to the end of the last layer begins at the nearest entry
    /// that is far enough, if there is one.
    fn solve_apart(
        &self,
        problem: &mut Problem,
        last: Option<Point>,
        solve: impl Fn(&Problem) -> Sequence,
    ) -> Sequence {
        let sequence = solve(problem);
        let distance_mm = self.settings.layer_distance.0;
        let Some(last) = last.filter(|_| distance_mm > 0.0) else { return sequence };
        let begins_apart = |problem: &Problem, sequence: &Sequence| {
            sequence.first().is_none_or(|first| {
                problem.items[first.item as usize].ends(first.entry).0.distance_mm(last) >= distance_mm
            })
        };
        if begins_apart(problem, &sequence) {
            return sequence;
        }
        let Some(begin) = nearest_apart(problem, last, distance_mm) else { return sequence };
        let start = problem.start.replace(begin);
        let apart = Some(solve(problem))
            .filter(|sequence| begins_apart(problem, sequence))
            .unwrap_or_else(|| Nearest.solve(problem, &self.cost, self.settings.effort));
        problem.start = start;
        if begins_apart(problem, &apart) { apart } else { sequence }
    }
}

/// The entry nearest to `last` that is at least so far away, among the items that may come first.
fn nearest_apart(problem: &Problem, last: Point, distance_mm: f64) -> Option<Point> {
    first_points(problem)
        .filter(|p| p.distance_mm(last) >= distance_mm)
        .min_by_key(|p| (p.distance2(last), *p))
}
