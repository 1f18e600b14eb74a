//! Layers of too many tools for every set of them to be looked at.

use super::problem::{ToolLayer, Weights};

/// A good order that begins with a tool, and its weight: always the cheapest next, then tools moved while that saves anything.
/// `None` if the tool has to wait for another. O(n³) a round.
pub(super) fn order(layer: &ToolLayer, first: u32, weights: &Weights) -> Option<(Vec<u32>, u64)> {
    let ready = |tool: u32, done: &[u32]| layer.needed(tool).all(|needed| done.contains(&needed));
    if !ready(first, &[]) {
        return None;
    }
    let mut order = vec![first];
    let mut left: Vec<u32> = layer.tools.iter().copied().filter(|&tool| tool != first).collect();
    left.sort_unstable();
    while !left.is_empty() {
        let last = order[order.len() - 1];
        let next =
            (0..left.len()).filter(|&k| ready(left[k], &order)).min_by_key(|&k| weights.of(last, left[k]))?;
        order.push(left.remove(next));
    }
    let weight = |order: &[u32]| order.windows(2).map(|pair| weights.of(pair[0], pair[1])).sum::<u64>();
    let allowed = |order: &[u32]| (0..order.len()).all(|k| ready(order[k], &order[..k]));
    let mut least = weight(&order);
    loop {
        let found = moved(&order)
            .map(|other| (weight(&other), other))
            .find(|(sum, other)| *sum < least && allowed(other));
        let Some((less, other)) = found else { break };
        (order, least) = (other, less);
    }
    Some((order, least))
}

/// Every order in which up to three consecutive tools stand elsewhere, the first tool where it is.
fn moved(order: &[u32]) -> impl Iterator<Item = Vec<u32>> + '_ {
    let n = order.len();
    let parts =
        (1..=3).flat_map(move |length| (1..(n + 1).saturating_sub(length)).map(move |from| (from, length)));
    parts.flat_map(move |(from, length)| {
        let mut rest = order.to_vec();
        let part: Vec<u32> = rest.drain(from..from + length).collect();
        (1..=rest.len()).filter(move |&to| to != from).map(move |to| {
            let mut other = rest.clone();
            other.splice(to..to, part.iter().copied());
            other
        })
    })
}

/// What every way through a layer from one tool to another weighs at least: all but the first are reached from another, all but the
/// last left to another.
pub(super) fn bound(layer: &ToolLayer, first: u32, last: u32, weights: &Weights) -> u64 {
    let others = |tool: u32| layer.tools.iter().copied().filter(move |&other| other != tool);
    let into = |tool: u32| others(tool).map(|from| weights.of(from, tool)).min().unwrap_or(0);
    let out_of = |tool: u32| others(tool).map(|to| weights.of(tool, to)).min().unwrap_or(0);
    others(first).map(into).sum::<u64>().max(others(last).map(out_of).sum())
}
