//! Orders the layers of a print chunk by chunk, and bounds what any order can reach.

use std::ops::Range;
use std::time::Duration;

use crate::order::compare::LayerRow;
use crate::order::{
    Chain, Cost, CostKind, LayerProblem, PathOrder, Pins, Problem, Visit, Watch, bound, ends_on_path,
    evaluate,
};
use crate::profile::{Effort, Settings};
use crate::toolpath::LayerPaths;
use geometry::Point;

use crate::parallel::Workers;

/// The chain of the settings.
pub(super) fn chain(settings: &Settings) -> Chain {
    Chain {
        settings: settings.order.clone(),
        cost: settings.order_cost(settings.order.cost),
        corners: None,
        detours: None,
        seam: settings.seam.position,
        origin: None,
    }
}

/// Layers and the order of each.
#[derive(Default)]
pub(super) struct Layers {
    pub paths: Vec<LayerPaths>,
    pub pins: Vec<Pins>,
    pub sequences: Vec<PathOrder>,
}

impl Layers {
    /// Where the first of them end, if they do anywhere.
    fn end(&self, count: usize) -> Option<Point> {
        let ordered = self.sequences[..count].iter().zip(&self.paths);
        ordered.rev().find_map(|(sequence, layer)| Some(ends_on_path(layer, *sequence.last()?).1))
    }

    fn split_off(&mut self, at: usize) -> Self {
        Self {
            paths: self.paths.split_off(at),
            pins: self.pins.split_off(at),
            sequences: self.sequences.split_off(at),
        }
    }
}

/// Orders the layers of a print batch by batch, with the same result as if they came all at once: in chunks, then those
/// around each join of chunks again with both ends known.
pub(super) struct Sequencer<'a> {
    chain: &'a Chain,
    workers: Workers<'a>,
    chunk: usize,
    /// Where the layers before end, but for those held back; before all, where the nozzle is.
    end: Option<Point>,
    /// Layers that take part in the next join.
    held: Layers,
    /// Time spent, of all threads together.
    pub took: Duration,
}

impl<'a> Sequencer<'a> {
    /// Begins at a place, if one is known. Chunks have `chunk` layers.
    pub(super) fn new(chain: &'a Chain, workers: Workers<'a>, chunk: usize, start: Option<Point>) -> Self {
        Self { chain, workers, chunk, end: start, held: Layers::default(), took: Duration::ZERO }
    }

    /// Takes up the next layers: whole chunks, unless they are the `last`. Returns those whose order is settled.
    pub(super) fn take(&mut self, paths: Vec<LayerPaths>, pins: Vec<Pins>, last: bool) -> Layers {
        let mut layers = std::mem::take(&mut self.held);
        let first = layers.paths.len();
        layers.paths.extend(paths);
        layers.pins.extend(pins);
        let (count, chunk) = (layers.paths.len(), self.chunk);
        let chunks = (count - first).div_ceil(chunk);
        let range = |c: usize| first + c * chunk..(first + (c + 1) * chunk).min(count);
        let (paths, pins) = (&layers.paths, &layers.pins);
        let (workers, timed) = (self.workers, Timed(self.workers));
        let look = || workers.go_on();
        let watch = Watch::new(&look);
        let solved = workers.map(chunks, |c| {
            timed.run(|| self.chain.solve_chunk(&paths[range(c)], &pins[range(c)], None, watch))
        });
        for (sequences, took) in solved {
            layers.sequences.extend(sequences);
            self.took += took;
        }
        // No two joins have a layer in common.
        let overlap = self.chain.overlap().min(chunk - 1);
        let window = |c: usize| range(c).start.saturating_sub(overlap)..range(c).start + 1;
        let joined =
            workers.map(chunks, |c| timed.run(|| self.join(&layers, window(c), range(c).end, watch)));
        let settled = if last { count } else { count.saturating_sub(overlap) };
        self.end = layers.end(settled).or(self.end);
        for (c, (sequences, took)) in joined.into_iter().enumerate() {
            layers.sequences.splice(window(c), sequences);
            self.took += took;
        }
        self.held = layers.split_off(settled);
        let Layers { paths, sequences, .. } = &mut layers;
        let orders = std::mem::take(sequences);
        let led =
            workers.map(orders.len(), |i| timed.run(|| self.chain.straight_on(&paths[i], orders[i].clone())));
        for (order, took) in led {
            sequences.push(order);
            self.took += took;
        }
        layers
    }

    /// Orders the layers of a join again. The chunk after it ends at `end`.
    fn join(&self, layers: &Layers, window: Range<usize>, end: usize, watch: Watch<'_>) -> Vec<PathOrder> {
        let old = layers.sequences[window.clone()].to_vec();
        let Some(before) = layers.end(window.start).or(self.end) else { return old };
        let above = window.end;
        let next = (above < end).then(|| (&layers.paths[above], layers.sequences[above].as_slice()));
        let (paths, pins) = (&layers.paths[window.clone()], &layers.pins[window]);
        self.chain.resolve_join(paths, pins, old, next, Some(before), watch)
    }
}

/// Measures how long work takes, where there is a clock.
#[derive(Clone, Copy)]
struct Timed<'a>(Workers<'a>);

impl Timed<'_> {
    fn run<T>(self, work: impl FnOnce() -> T) -> (T, Duration) {
        let begun = self.0.observer.now();
        let done = work();
        (done, self.0.observer.now().saturating_sub(begun))
    }
}

/// Lower bounds of the links of a print and of each of its layers, whatever the strategy: of lengths, and of times where ordering
/// minimises these.
pub(super) struct Certificate {
    lengths: Vec<bound::Share>,
    times: Option<(Cost, Vec<bound::Share>)>,
    start: Option<Point>,
}

impl Certificate {
    /// Bounds for layers whose first is entered from `start`.
    pub(super) fn new(
        layers: &[(LayerPaths, Pins)],
        settings: &Settings,
        start: Option<Point>,
        workers: Workers<'_>,
    ) -> Self {
        let mut problems: Vec<Problem> = layers
            .iter()
            .map(|(layer, pins)| LayerProblem::new(layer, pins, settings.order.scope).problem)
            .collect();
        if let Some(first) = problems.iter_mut().find(|problem| !problem.items.is_empty()) {
            first.start = start;
        }
        let shares = |cost: &Cost| {
            bound::shares(&problems, cost, settings.order.effort, |n, chunk| workers.map(n, chunk))
        };
        let cost = settings.order_cost(settings.order.cost);
        let times = (cost != Cost::Length).then(|| (cost, shares(&cost)));
        Self { lengths: shares(&Cost::Length), times, start }
    }

    /// A length that the links of a layer, entered from `start`, cannot stay below.
    pub(super) fn layer_mm(&self, layer: usize, start: Option<Point>) -> f64 {
        self.lengths[layer].layer(&Cost::Length, start, None)
    }

    /// A length that the links of the whole print cannot stay below.
    pub(super) fn print_mm(&self) -> f64 {
        bound::Share::print(&self.lengths, &Cost::Length, self.start, None)
    }

    /// A time that the links of a layer, entered from `start`, cannot stay below, in seconds.
    pub(super) fn layer_s(&self, layer: usize, start: Option<Point>) -> Option<f64> {
        self.times.as_ref().map(|(cost, shares)| shares[layer].layer(cost, start, None))
    }

    /// A time that the links of the whole print cannot stay below, in seconds.
    pub(super) fn print_s(&self) -> Option<f64> {
        self.times.as_ref().map(|(cost, shares)| bound::Share::print(shares, cost, self.start, None))
    }
}

/// What the links of an order come to, if its layer is entered from `start`.
pub(super) fn measured(
    index: usize,
    layer: &LayerPaths,
    order: &PathOrder,
    start: Option<Point>,
    settings: &Settings,
) -> LayerRow {
    // Orders name vertices of paths: measured on the problem whose seams are free.
    let mut free = LayerProblem::new(layer, &None, settings.order.scope);
    free.problem.start = start;
    LayerRow::new(index, &free.problem, &free.from_paths(order), &settings.order_cost(CostKind::Time))
}

/// By how much, as a share, an order's links cost more at most than the cheapest from where the layer is entered to where the next
/// begins; `None` where that is not known.
pub(super) fn excess(
    (layer, pins): (&LayerPaths, &Pins),
    order: &PathOrder,
    ends: [Option<Point>; 2],
    settings: &Settings,
) -> Option<f64> {
    let cost = settings.order_cost(settings.order.cost);
    // More than rounding takes off a link: in millimetres, in seconds.
    let rounding = if cost == Cost::Length { 1e-6 } else { 1e-8 };
    let between = |pins| {
        let mut layer = LayerProblem::new(layer, pins, settings.order.scope);
        [layer.problem.start, layer.problem.end] = ends;
        layer
    };
    // Sequences name vertices of paths, wherever the seam may be.
    let free = between(&None);
    let found = free.from_paths(order);
    let links = evaluate(&free.problem, &found, &cost);
    let bound = least(&between(pins).problem, &found, &cost, settings.order.effort)?;
    if links <= bound + rounding * (order.len() + 1) as f64 {
        return Some(0.0);
    }
    Some(links / bound - 1.0).filter(|excess| excess.is_finite())
}

/// What no order of a layer can cost less than, if anything says so: relaxed walks, and where these leave a gap a linear program.
fn least(problem: &Problem, found: &[Visit], cost: &Cost, effort: Effort) -> Option<f64> {
    let walks = bound::by_walks(problem, found, cost, effort).map(|proof| proof.bound);
    #[cfg(feature = "highs")]
    if walks.is_none_or(|bound| bound < evaluate(problem, found, cost)) {
        let program = bound::by_program(problem, cost, effort);
        return walks.into_iter().chain(program).reduce(f64::max);
    }
    walks
}
