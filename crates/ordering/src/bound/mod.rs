//! Lower bounds on what any order of a layer, or of a print, must travel.
//!
//! A walk through all paths is a tree of links: within every group that precedence keeps together, and over the groups.
//! The cheapest such tree is a lower bound, and remains one when links pay multipliers, as long as what every walk
//! would pay is given back: one link at each end of an open path, two at a loop, an odd number out of certain sets. The
//! ascent looks for multipliers under which the tree resembles a walk; whatever it finds, the bound is evaluated over
//! *all* links, in integers, each link rounded down. `docs/ordering-bounds.md` has the proof and the figures.

mod arborescence;
mod ascent;
mod cuts;
mod directions;
mod link;
mod model;
mod network;
mod passages;
mod points;
mod pricing;
#[cfg(feature = "highs")]
mod program;
mod relaxation;
mod solution;
mod stack;
mod tree;
mod walks;

use std::ops::Range;
use std::sync::Arc;

use super::cost::LinkCosts;
use super::{Cost, Effort, LinkKind, Optimized, Problem, Sequence, Strategy, Visit, check};
use ascent::ascend;
use model::{Model, from_fine, price};
use pathwright_geometry::Point;
use points::PricedPoints;
#[cfg(feature = "highs")]
pub use program::{Certificate, Cut, Tie};
use relaxation::{Multipliers, Relaxation};
use solution::{half_links, outer, prices};
use walks::{Budget, Settled, Walks};

/// The share of a layer in a bound, wherever it is entered and left: its multipliers and their result.
#[derive(Clone, Debug, Default)]
pub struct Share {
    own: Part,
    /// That of several neighbouring layers as one, and which of them this is.
    joint: Option<(Arc<Joint>, usize)>,
}

/// What layers cost, wherever their walk is entered and left.
#[derive(Clone, Debug, Default)]
struct Part {
    /// Everything but the links in and out, in fine units.
    inner: i64,
    /// Where a walk may begin and where it may end, with what a link pays there.
    ends: [Vec<(Point, i64)>; 2],
}

#[derive(Debug)]
struct Joint {
    layers: usize,
    part: Part,
}

/// Where a layer's walk comes from, or continues to, while its multipliers are sought.
enum Beyond<'a> {
    /// Not known: the link there is left out.
    Anything,
    At(Point),
    /// A layer whose multipliers are not known yet.
    Layer(&'a Problem<'a>),
    Share(&'a Share),
}

impl Beyond<'_> {
    /// The points at the other end of the link; `below`: whether a layer is left there, not entered.
    fn points(&self, below: bool, cost: &Cost) -> Option<PricedPoints> {
        let points = match self {
            Self::Anything => return None,
            Self::At(at) => vec![(*at, 0)],
            Self::Layer(problem) => {
                Model::new(problem, cost).ends(usize::from(below)).map(|p| (p, 0)).collect()
            }
            Self::Share(share) => share.outer().ends[usize::from(below)].clone(),
        };
        Some(PricedPoints::new(points, cost))
    }
}

/// A layer whose multipliers are sought.
struct Climber<'a> {
    problem: &'a Problem<'a>,
    model: &'a Model,
    cost: &'a Cost,
    #[cfg(feature = "highs")]
    effort: Effort,
    /// A solution.
    solved: Sequence,
    /// Whether walks may be left out that are much longer: when multipliers are sought once only.
    limited: bool,
    /// Unless they are too many.
    walks: Option<Walks<'a>>,
    /// A tree instead of a walk, and the best multipliers so far; unless the walks do better.
    tree: Option<(Relaxation<'a>, Option<Multipliers>)>,
}

/// What is left out costs more than a solution by so many times its mean link; where what links pay below makes that negative, no
/// more than the solution.
const MARGIN: i64 = 2;
/// Trees are not asked where the bound is within this share of a solution's links below the limit.
const CLOSE: f64 = 0.3;
/// Nor is a program, where the bound is within this part of a solution's links below the solution.
#[cfg(feature = "highs")]
const ENOUGH: i64 = 200;

impl<'a> Climber<'a> {
    fn new(
        problem: &'a Problem<'a>,
        model: &'a Model,
        cost: &'a Cost,
        effort: Effort,
        limited: bool,
    ) -> Self {
        let solved = Optimized.solve(problem, cost, Effort::Fast);
        let budget = if limited { Budget::limited(effort) } else { Budget::new(effort) };
        let walks = Walks::new(model, half_links(problem, &solved, cost), budget);
        Self {
            problem,
            model,
            cost,
            #[cfg(feature = "highs")]
            effort,
            solved,
            limited,
            walks,
            tree: None,
        }
    }

    /// Seeks better multipliers for what lies below and above. `down`: the layer below is next. `is_last`: multipliers are not sought
    /// many times more.
    #[cfg_attr(not(feature = "highs"), expect(unused_variables))]
    fn climb(&mut self, below: &Beyond, above: &Beyond, down: bool, is_last: bool) -> Share {
        let ends = [below.points(true, self.cost), above.points(false, self.cost)];
        let costs = (0..).zip(&ends).filter_map(|(side, points)| Some((side, points.as_ref()?)));
        let beyond = |side: usize, p| ends[side].as_ref().map_or(0, |points| points.nearest(p));
        let links: i64 = prices(self.problem, &self.solved, self.cost).sum();
        let solved = links + outer(self.problem, &self.solved, beyond);
        let limit =
            self.limited.then_some(solved + 1 + MARGIN * solved.max(0) / self.problem.items.len() as i64);
        let mut walked = None;
        let mut is_close = false;
        if let Some(walks) = &mut self.walks {
            costs.clone().for_each(|(side, points)| walks.measure(side, |p| points.nearest(p)));
            walks.climb(limit);
            walked = Some((walks.bound, walks.closed));
            is_close = walks.closed
                || limit.is_some_and(|limit| (limit - walks.bound) as f64 <= CLOSE * links.max(1) as f64);
        }
        let mut best: Option<(i64, Settled)> = None;
        #[cfg(feature = "highs")]
        if is_last && walked.is_none_or(|(bound, is_closed)| !is_closed && solved - bound > links / ENOUGH) {
            best = program::Climb::new(self.problem, self.cost, &ends, self.effort).best().map(|found| {
                is_close |= found.is_final;
                (found.bound, found.settled)
            });
        }
        if !is_close {
            let (relaxation, multipliers) =
                self.tree.get_or_insert_with(|| (Relaxation::new(self.model), None));
            costs.for_each(|(side, points)| relaxation.measure(side, |p| points.nearest(p)));
            let (bound, found) = ascend(relaxation, multipliers.take());
            if best.as_ref().is_none_or(|best| best.0 <= bound) {
                best = Some((bound, relaxation.settle(bound, &found)));
            }
            *multipliers = Some(found);
        }
        let better = best.filter(|best| walked.is_none_or(|(bound, _)| bound <= best.0)).map(|best| best.1);
        let settled = better.or_else(|| Some(self.walks.as_ref()?.settle(down).swap_remove(0)));
        settled.map_or_else(Share::default, Share::of)
    }
}

impl Part {
    fn of((inner, ends): Settled) -> Self {
        Self { inner, ends }
    }

    /// The least price of a link in or out, from or to a point that may be unknown.
    fn end_price(&self, side: usize, point: Option<Point>, cost: &Cost) -> i64 {
        let costs = LinkCosts::from(*cost);
        let link = |p: Point| point.map_or(0, |point| price(&costs, point, p, LinkKind::UP));
        self.ends[side].iter().map(|&(p, pay)| pay + link(p)).min().unwrap_or(0)
    }

    /// What parts one after the other cost at least, but for the links into the first and out of the last.
    fn chain(parts: &[&Self], cost: &Cost) -> i64 {
        let inner: i64 = parts.iter().map(|part| part.inner).sum();
        inner + parts.windows(2).map(|pair| pair[0].link_to(pair[1], cost)).sum::<i64>()
    }

    /// The least price of the link from these layers to the next.
    fn link_to(&self, next: &Self, cost: &Cost) -> i64 {
        let points = PricedPoints::new(self.ends[1].clone(), cost);
        next.ends[0].iter().map(|&(p, pay)| points.nearest(p) + pay).min().unwrap_or(0)
    }
}

impl Share {
    fn of(settled: Settled) -> Self {
        Self { own: Part::of(settled), joint: None }
    }

    fn is_empty(&self) -> bool {
        self.own.ends.iter().all(Vec::is_empty)
    }

    /// What neighbours know of the layer: if it is bounded with others, what they know of all these.
    fn outer(&self) -> &Part {
        self.joint.as_ref().map_or(&self.own, |(joint, _)| &joint.part)
    }

    /// The parts of neighbouring layers: one of those that are bounded as one, if all of them are there.
    fn parts<'a>(layers: &[&'a Self]) -> Vec<&'a Part> {
        let (mut parts, mut at) = (Vec::new(), 0);
        while let Some(&first) = layers.get(at) {
            let is_nth = |joint: &Arc<Joint>, nth: usize| {
                let other = layers.get(at + nth).and_then(|layer| layer.joint.as_ref());
                other.is_some_and(|(other, place)| Arc::ptr_eq(joint, other) && *place == nth)
            };
            let joint = first.joint.as_ref().map(|(joint, _)| joint);
            let joint = joint.filter(|joint| (0..joint.layers).all(|nth| is_nth(joint, nth)));
            parts.push(joint.map_or(&first.own, |joint| &joint.part));
            at += joint.map_or(1, |joint| joint.layers);
        }
        parts
    }

    /// What layers one after the other cost at least, with the links to what lies below and above.
    fn chain(layers: &[&Self], ends: &[Option<PricedPoints>; 2], cost: &Cost) -> i64 {
        let parts = Self::parts(layers);
        let (Some(first), Some(last)) = (parts.first(), parts.last()) else { return 0 };
        let end = |side: usize, part: &Part| {
            let link = |p: Point| ends[side].as_ref().map_or(0, |points| points.nearest(p));
            part.ends[side].iter().map(|&(p, pay)| link(p) + pay).min().unwrap_or(0)
        };
        end(0, first) + Part::chain(&parts, cost) + end(1, last)
    }

    /// What the layer's links cannot cost less than, entered from `start` and left for `end`, where these are known: millimetres
    /// or seconds, by the cost with which the share was found.
    pub fn layer(&self, cost: &Cost, start: Option<Point>, end: Option<Point>) -> f64 {
        let ends = self.own.end_price(0, start, cost) + self.own.end_price(1, end, cost);
        from_fine(cost, (self.own.inner + ends).max(0))
    }

    /// What the links of a whole print cannot cost less than, however its layers are ordered and wherever they begin and end.
    /// Layers without paths are passed over. A link between layers is of [`LinkKind::UP`].
    pub fn print(layers: &[Self], cost: &Cost, start: Option<Point>, end: Option<Point>) -> f64 {
        let layers: Vec<&Self> = layers.iter().filter(|share| !share.is_empty()).collect();
        let parts = Self::parts(&layers);
        let (Some(first), Some(last)) = (parts.first(), parts.last()) else { return 0.0 };
        let ends = first.end_price(0, start, cost) + last.end_price(1, end, cost);
        from_fine(cost, (ends + Part::chain(&parts, cost)).max(0))
    }
}

/// Layers that are taken one after the other. Between neighbours of which neither knows what links pay at the other the
/// bound loses most.
const CHUNK: usize = 16;

/// How often the multipliers of a layer are sought, each time with what its neighbours have found. On five models with pinned
/// seams at `feature` the gap is 6.9 % after one pass, 6.4 after two, 5.6 after six, 5.1 after twelve.
const PASSES: usize = 6;

/// How often neighbouring layers are bounded as one.
#[cfg(feature = "highs")]
const JOINT_PASSES: usize = 2;

/// The shares of a print's layers, from the first to the last; empty for a layer without paths. The start of the
/// first and the end of the last count where they are known.
///
/// A layer knows what links to the layer below pay there. Chunks of layers are independent: first every other one,
/// then those between. `map(n, f)` gives f(0), …, f(n − 1) and may call them in any order.
pub fn shares(
    layers: &[Problem],
    cost: &Cost,
    effort: Effort,
    map: impl Fn(usize, &(dyn Fn(usize) -> Vec<Share> + Sync)) -> Vec<Vec<Share>>,
) -> Vec<Share> {
    let used: Vec<usize> = (0..layers.len()).filter(|&i| !layers[i].items.is_empty()).collect();
    let used: Vec<&Problem> = used.iter().map(|&i| &layers[i]).collect();
    let mut known: Vec<Option<Share>> = vec![None; used.len()];
    let chunks = used.len().div_ceil(CHUNK);
    for turn in 0..2 {
        let done =
            map((chunks + 1 - turn) / 2, &|k| chunk(&used, &known, (2 * k + turn) * CHUNK, cost, effort));
        for (k, shares) in done.into_iter().enumerate() {
            let first = (2 * k + turn) * CHUNK;
            known[first..first + shares.len()]
                .iter_mut()
                .zip(shares)
                .for_each(|(at, share)| *at = Some(share));
        }
    }
    let mut known = known.into_iter().flatten();
    let share = |layer: &Problem| if layer.items.is_empty() { None } else { known.next() };
    layers.iter().map(share).map(Option::unwrap_or_default).collect()
}

/// The shares of one chunk of layers, the first of which is given, none without paths: up and down, several times.
fn chunk(
    layers: &[&Problem],
    known: &[Option<Share>],
    first: usize,
    cost: &Cost,
    effort: Effort,
) -> Vec<Share> {
    let last = (first + CHUNK).min(layers.len());
    let models: Vec<Model> = layers[first..last].iter().map(|problem| Model::new(problem, cost)).collect();
    // Free loops take several times as long, and what they lose is lost elsewhere.
    let passes = if models.iter().any(Model::has_pieces) { 1 } else { PASSES };
    let layer = |(problem, model)| Climber::new(problem, model, cost, effort, passes == 1);
    let mut climbers: Vec<Climber> = layers[first..last].iter().copied().zip(&models).map(layer).collect();
    let mut done: Vec<Option<Share>> = vec![None; last - first];
    for pass in 0..passes {
        for step in first..last {
            let at = if pass % 2 == 0 { step } else { first + last - 1 - step };
            let [below, above] = around(layers, known, (first, &done), at..at + 1);
            let share = climbers[at - first].climb(&below, &above, pass % 2 == 1, pass + 2 >= passes);
            done[at - first] = Some(share);
        }
    }
    for stack in stack::stacks(&layers[first..last], |at| climbers[at].walks.is_some()) {
        let problems = &layers[first..last][stack.clone()];
        let model = Model::new(&stack::stacked(problems), cost);
        let parts: Vec<&Walks> =
            climbers[stack.clone()].iter().filter_map(|climber| climber.walks.as_ref()).collect();
        let Some(mut walks) = Walks::joined(&model, &parts, Budget::new(effort)) else { continue };
        let [below, above] = around(layers, known, (first, &done), first + stack.start..first + stack.end);
        let ends = [below.points(true, cost), above.points(false, cost)];
        for (side, points) in (0..).zip(&ends).filter_map(|(side, points)| Some((side, points.as_ref()?))) {
            walks.measure(side, |p| points.nearest(p));
        }
        walks.climb(None);
        let old: Vec<&Share> = done[stack.clone()].iter().flatten().collect();
        if walks.bound > Share::chain(&old, &ends, cost) {
            for (at, settled) in stack.zip(walks.settle(false)) {
                done[at] = Some(Share::of(settled));
            }
        }
    }
    #[cfg(feature = "highs")]
    if passes > 1 {
        join(layers, known, (first, &mut done), cost, effort);
    }
    done.into_iter().flatten().collect()
}

/// Bounds neighbouring layers of one chunk as one, by linear programs, where that says more: up and down, since what links pay at the
/// others changes.
#[cfg(feature = "highs")]
fn join(
    layers: &[&Problem],
    known: &[Option<Share>],
    (first, done): (usize, &mut [Option<Share>]),
    cost: &Cost,
    effort: Effort,
) {
    let windows = stack::windows(&layers[first..first + done.len()]);
    for pass in 0..JOINT_PASSES {
        for step in 0..windows.len() {
            let window = windows[if pass % 2 == 0 { step } else { windows.len() - 1 - step }].clone();
            let some = first + window.start..first + window.end;
            let stack = stack::stacked(&layers[some.clone()]);
            let [below, above] = around(layers, known, (first, done), some);
            let ends = [below.points(true, cost), above.points(false, cost)];
            let Some(best) = program::Climb::new(&stack, cost, &ends, effort).best() else { continue };
            let own: Vec<&Share> = done[window.clone()].iter().flatten().collect();
            if best.bound > Share::chain(&own, &ends, cost) {
                let joint = Arc::new(Joint { layers: window.len(), part: Part::of(best.settled) });
                for (nth, share) in done[window].iter_mut().flatten().enumerate() {
                    share.joint = Some((joint.clone(), nth));
                }
            }
        }
    }
}

/// What lies below and above some layers, those of one chunk, which begins with a layer, being done or not.
fn around<'a>(
    layers: &'a [&'a Problem<'a>],
    known: &'a [Option<Share>],
    (first, done): (usize, &'a [Option<Share>]),
    some: Range<usize>,
) -> [Beyond<'a>; 2] {
    let beyond = |k: usize, point: Option<Point>| match layers.get(k) {
        Some(layer) => {
            let own = k.checked_sub(first).and_then(|at| done.get(at)).unwrap_or(&known[k]);
            own.as_ref().map_or(Beyond::Layer(layer), Beyond::Share)
        }
        None => point.map_or(Beyond::Anything, Beyond::At),
    };
    // Below the first layer there is no layer usize::MAX either.
    let below = beyond(some.start.wrapping_sub(1), layers[some.start].start);
    [below, beyond(some.end, layers[some.end - 1].end)]
}

/// What the links of no solution of the problem can cost less than: millimetres or seconds.
pub fn layer(problem: &Problem, cost: &Cost, effort: Effort) -> f64 {
    print(std::slice::from_ref(problem), cost, effort)
}

/// What relaxed walks say of a layer.
#[derive(Clone, Debug)]
pub struct Proof {
    /// What the links of no solution can cost less than: millimetres or seconds.
    pub bound: f64,
    /// A solution that costs less than the one at hand, and is an optimum, if there is one and it was found.
    pub better: Option<Sequence>,
}

/// What relaxed walks say of a layer; `None` if it is too large to look at enough of them. `solved` is a solution at hand, with
/// whatever entries.
///
/// Rounding takes less than a nanometre, or 3 nanoseconds, off each link.
pub fn by_walks(problem: &Problem, solved: &[Visit], cost: &Cost, effort: Effort) -> Option<Proof> {
    let entries = |item: u32| problem.items[item as usize].shape.entries().len() as u32;
    let permitted = |visit: &Visit| Visit { entry: visit.entry.min(entries(visit.item) - 1), ..*visit };
    let solved = &solved.iter().map(permitted).collect::<Vec<_>>();
    let model = Model::new(problem, cost);
    let mut walks = Walks::new(&model, half_links(problem, solved, cost), Budget::limited(effort))?;
    let (costs, ends) = (LinkCosts::from(*cost), [problem.start, problem.end]);
    let beyond = |side: usize, p: Point| ends[side].map_or(0, |end| price(&costs, end, p, LinkKind::UP));
    [0, 1].into_iter().for_each(|side| walks.measure(side, |p| beyond(side, p)));
    walks.climb(Some(prices(problem, solved, cost).sum::<i64>() + outer(problem, solved, beyond)));
    let better = walks.solution().filter(|order| check(problem, order).is_ok());
    Some(Proof { bound: from_fine(cost, walks.bound.max(0)), better })
}

/// What the links of no solution of the problem can cost less than, as a linear program says: millimetres or seconds; `None` if
/// nothing may be spent on it, or its solver fails.
#[cfg(feature = "highs")]
pub fn by_program(problem: &Problem, cost: &Cost, effort: Effort) -> Option<f64> {
    let ends = beyond(problem, cost);
    let best = program::Climb::new(problem, cost, &ends, effort).best()?;
    Some(from_fine(cost, best.bound.max(0)))
}

/// As [`by_program`] of lengths, with all that the bound follows from; `None` also where precedence orders paths.
#[cfg(feature = "highs")]
pub fn certificate(problem: &Problem, effort: Effort) -> Option<Certificate> {
    let ends = beyond(problem, &Cost::Length);
    let climb = program::Climb::new(problem, &Cost::Length, &ends, effort);
    climb.certified([problem.start, problem.end]).best()?.certificate
}

/// Where the problem's walks come from and go to.
#[cfg(feature = "highs")]
fn beyond(problem: &Problem, cost: &Cost) -> [Option<PricedPoints>; 2] {
    [problem.start, problem.end].map(|end| end.map_or(Beyond::Anything, Beyond::At).points(true, cost))
}

/// What the links of a whole print cannot cost less than: millimetres or seconds; see [`shares`] and [`Share::print`].
pub fn print(layers: &[Problem], cost: &Cost, effort: Effort) -> f64 {
    let shares = shares(layers, cost, effort, |n, chunk| (0..n).map(chunk).collect());
    let mut used = layers.iter().filter(|layer| !layer.items.is_empty());
    let start = used.next().and_then(|first| first.start);
    let end = layers.iter().rfind(|layer| !layer.items.is_empty()).and_then(|last| last.end);
    Share::print(&shares, cost, start, end)
}
