//! The rules of other slicers, to compare with.

use super::problem::{ToolLayer, ToolProblem};

/// Ascending numbers on every layer.
pub(super) fn fixed(problem: &ToolProblem) -> Vec<Vec<u32>> {
    problem.layers.iter().map(ascending).collect()
}

/// The loaded tool first, if it can be.
pub(super) fn loaded_first(problem: &ToolProblem) -> Vec<Vec<u32>> {
    let mut loaded = problem.loaded;
    let mut order = |layer: &ToolLayer| {
        let mut tools = ascending(layer);
        to_front(&mut tools, layer, loaded);
        loaded = tools.last().copied().or(loaded);
        tools
    };
    problem.layers.iter().map(&mut order).collect()
}

/// The loaded tool first, and the first that the next layer has as well last, if they can be.
pub(super) fn next_last(problem: &ToolProblem) -> Vec<Vec<u32>> {
    let mut loaded = problem.loaded;
    let used: Vec<usize> =
        (0..problem.layers.len()).filter(|&k| !problem.layers[k].tools.is_empty()).collect();
    let mut orders = vec![Vec::new(); problem.layers.len()];
    for (at, &k) in used.iter().enumerate() {
        let layer = &problem.layers[k];
        let mut tools = ascending(layer);
        to_front(&mut tools, layer, loaded);
        if let Some(&next) = used.get(at + 1) {
            let next = ascending(&problem.layers[next]);
            let follows =
                |tool: &u32| layer.tools.iter().any(|&other| layer.needed(other).any(|first| first == *tool));
            // The one that comes first stays there, as this layer began with it.
            let shared = next.iter().find(|tool| tools[1..].contains(tool) && !follows(tool));
            if let Some(&last) = shared {
                tools.retain(|&tool| tool != last);
                tools.push(last);
            }
        }
        loaded = tools.last().copied();
        orders[k] = tools;
    }
    orders
}

fn ascending(layer: &ToolLayer) -> Vec<u32> {
    layer.ascending().unwrap_or_default()
}

/// Moves a tool to the front if the layer has it and it need not wait.
fn to_front(tools: &mut Vec<u32>, layer: &ToolLayer, tool: Option<u32>) {
    if let Some(first) = tool.filter(|tool| tools.contains(tool) && layer.needed(*tool).next().is_none()) {
        tools.retain(|&tool| tool != first);
        tools.insert(0, first);
    }
}
