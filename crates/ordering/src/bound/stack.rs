//! Small layers that lie above each other, looked at as one: so each knows all that happens in the others.

use std::ops::Range;

use super::super::{Item, Problem, Run};
#[cfg(feature = "highs")]
use super::directions::MOST_RUNS;
use super::walks::MOST;

/// Paths and vertices of layers that are looked at together, at most.
const PATHS: usize = 96;
const VERTICES: usize = 3000;

/// Neighbouring layers that are looked at together, of those that may be: two at least.
pub(super) fn stacks(layers: &[&Problem], may: impl Fn(usize) -> bool) -> Vec<Range<usize>> {
    let size = |layer: &Problem| {
        [layer.items.len(), layer.runs.len(), layer.items.iter().map(|item| item.shape.entries().len()).sum()]
    };
    let mut stacks = Vec::new();
    let (mut first, mut sum) = (0, [0; 3]);
    for at in 0..=layers.len() {
        let fits = layers.get(at).filter(|_| may(at)).is_some_and(|layer| {
            let more = size(layer);
            let sums = [0, 1, 2].map(|k| sum[k] + more[k]);
            let fits = sums.iter().zip([PATHS, MOST, VERTICES]).all(|(&sum, most)| sum <= most)
                && layers[first].scope == layer.scope;
            sum = if fits { sums } else { more };
            fits
        });
        if !fits {
            stacks.push(first..at);
            first = if at < layers.len() && may(at) { at } else { at + 1 };
        }
    }
    stacks.retain(|stack| stack.len() > 1);
    stacks
}

/// Paths of layers that are one linear program, at most: twice as many take four times as long.
#[cfg(feature = "highs")]
const PROGRAM: usize = 340;

/// Neighbouring layers that are one linear program, two at least, of about as many paths each.
#[cfg(feature = "highs")]
pub(super) fn windows(layers: &[&Problem]) -> Vec<Range<usize>> {
    let mut windows: Vec<Range<usize>> = Vec::new();
    let mut first = 0;
    while first < layers.len() {
        let sums = layers[first..].iter().scan([0; 2], |sums, layer| {
            *sums = [sums[0] + layer.items.len(), sums[1] + layer.runs.len()];
            Some(*sums)
        });
        let count = sums.take_while(|&[paths, runs]| paths <= PROGRAM && runs <= MOST_RUNS).count().max(1);
        windows.push(first..first + count);
        first += count;
    }
    // The last two are about as long.
    if let [.., before, last] = &mut windows[..] {
        let middle = (before.start + last.end).div_ceil(2).min(last.start);
        (before.end, last.start) = (middle, middle);
    }
    windows.retain(|window| window.len() > 1);
    windows
}

/// Layers as one problem, in which the stages of each come after those of the one below.
pub(super) fn stacked<'a>(layers: &[&Problem<'a>]) -> Problem<'a> {
    let stages = layers.iter().flat_map(|layer| &layer.runs).map(|run| run.stage + 1).max().unwrap_or(0);
    let islands = layers.iter().flat_map(|layer| layer.runs.iter().map(|run| run.island));
    let mut islands: Vec<u32> = islands.collect();
    islands.sort_unstable();
    islands.dedup();
    let (mut items, mut runs) = (Vec::new(), Vec::new());
    for (number, layer) in (0..).zip(layers) {
        let first = runs.len() as u32;
        runs.extend(layer.runs.iter().map(|run| Run {
            stage: run.stage + stages * number,
            // No link between layers stays inside an island.
            island: (islands.partition_point(|&island| island < run.island) + islands.len() * number as usize)
                as u32,
            layer: number,
            ..*run
        }));
        items.extend(layer.items.iter().map(|item| Item { run: item.run + first, ..*item }));
    }
    Problem { items, runs, start: None, end: None, ..layers[0].clone() }
}
