//! Orders the layers of a print chunk by chunk, and bounds what any order can reach.

use std::time::{Duration, Instant};

use crate::geom::Point;
use crate::order::{Chain, Cost, LayerProblem, Pins, Problem, Sequence, bound, ends_on_path};
use crate::profile::Settings;
use crate::toolpath::LayerPaths;

use super::parallel;

/// The chain that the settings ask for.
pub(super) fn chain(settings: &Settings) -> Chain {
    Chain {
        settings: settings.order.clone(),
        cost: Cost::new(settings.order.cost, settings),
        seam: settings.seam.position,
        origin: None,
    }
}

/// Ordered layers.
pub(super) struct Solved {
    /// One sequence for each layer.
    pub sequences: Vec<Sequence>,
    /// Time spent, of all threads together.
    pub took: Duration,
}

/// Orders layers in chunks of `chunk`, then those around each join of chunks again with both ends known. `start` is where
/// the nozzle is before the first of them.
pub(super) fn solve(
    chain: &Chain,
    paths: &[LayerPaths],
    pins: &[Pins],
    chunk: usize,
    start: Option<Point>,
) -> Solved {
    let chunks = paths.len().div_ceil(chunk);
    let range = |c: usize| c * chunk..((c + 1) * chunk).min(paths.len());
    let solved =
        parallel::map(chunks, |c| timed(|| chain.solve_chunk(&paths[range(c)], &pins[range(c)], None)));
    let mut took: Duration = solved.iter().map(|(_, took)| *took).sum();
    let mut sequences: Vec<Sequence> = solved.into_iter().flat_map(|(sequences, _)| sequences).collect();
    // Joins have no layer in common.
    let overlap = chain.overlap().min(chunk - 1);
    let join = |c: usize| (c * chunk).saturating_sub(overlap)..c * chunk + 1;
    let joined = parallel::map(chunks, |c| {
        let window = join(c);
        let before = sequences[..window.start]
            .iter()
            .zip(paths)
            .rev()
            .find_map(|(sequence, layer)| Some(ends_on_path(layer, *sequence.last()?).1));
        let before = before.or(start);
        let old = sequences[window.clone()].to_vec();
        let next =
            range(c).contains(&window.end).then(|| (&paths[window.end], sequences[window.end].as_slice()));
        timed(|| match before {
            Some(_) => chain.resolve_join(&paths[window.clone()], &pins[window], old, next, before),
            None => old,
        })
    });
    for (c, (new, spent)) in joined.into_iter().enumerate() {
        took += spent;
        sequences.splice(join(c), new);
    }
    Solved { sequences, took }
}

fn timed<T>(work: impl FnOnce() -> T) -> (T, Duration) {
    let begun = Instant::now();
    let done = work();
    (done, begun.elapsed())
}

/// Lower bounds of the links of a print and of each of its layers, whatever the strategy.
pub(super) struct Certificate {
    shares: Vec<bound::Share>,
    start: Option<Point>,
}

impl Certificate {
    /// Bounds for layers whose first is entered from `start`.
    pub(super) fn new(layers: &[(LayerPaths, Pins)], settings: &Settings, start: Option<Point>) -> Self {
        let mut problems: Vec<Problem> = layers
            .iter()
            .map(|(layer, pins)| LayerProblem::new(layer, pins, settings.order.scope).problem)
            .collect();
        if let Some(first) = problems.iter_mut().find(|problem| !problem.items.is_empty()) {
            first.start = start;
        }
        Self { shares: bound::shares(&problems, |n, chunk| parallel::map(n, chunk)), start }
    }

    /// A length that the links of a layer, entered from `start`, cannot stay below.
    pub(super) fn layer_mm(&self, layer: usize, start: Option<Point>) -> f64 {
        self.shares[layer].layer_mm(start, None)
    }

    /// A length that the links of the whole print cannot stay below.
    pub(super) fn print_mm(&self) -> f64 {
        bound::Share::print_mm(&self.shares, self.start, None)
    }
}
