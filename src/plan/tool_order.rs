//! Which tool prints when: the tools of each layer, in their order.

use crate::order::compare_tools::ToolOrderRow;
use crate::order::tools::{ToolLayer, ToolOrder, ToolPlan, ToolProblem, order_tools};
use crate::profile::Settings;
use crate::toolpath::{LayerPaths, ToolId};

/// Milliseconds in a second, in which changes are weighed.
const MS: f64 = 1000.0;

/// The tools that each layer of a print needs, and what it costs to change them.
pub(crate) fn problem(layers: &[LayerPaths], start: Option<ToolId>, settings: &Settings) -> ToolProblem {
    let layer = |layer: &LayerPaths| {
        let mut tools: Vec<u32> = layer.paths.iter().filter_map(|path| path.tool).map(u32::from).collect();
        tools.sort_unstable();
        tools.dedup();
        ToolLayer { tools, before: Vec::new() }
    };
    let tools = settings.tools.len();
    let seconds = seconds(settings);
    let cost = |from: usize, to: usize| {
        let waste_s = settings.tool_change.waste_weight * settings.flush_mm3(from, to);
        if from == to { 0 } else { (MS * (seconds[to] + waste_s)).round() as u32 }
    };
    ToolProblem {
        layers: layers.iter().map(layer).collect(),
        change: (0..tools).map(|from| (0..tools).map(|to| cost(from, to)).collect()).collect(),
        loaded: start.map(u32::from),
    }
}

/// How long it takes to change to each tool.
fn seconds(settings: &Settings) -> Vec<f64> {
    (0..settings.tools.len()).map(|to| settings.of_tool(to).tool_change.time.0).collect()
}

/// The order of the tools of each layer, by a rule.
pub(crate) fn plan(problem: &ToolProblem, order: ToolOrder) -> ToolPlan {
    order_tools(problem, order).expect("tools are those of the settings, and none waits for another")
}

/// What an order comes to.
pub(crate) fn row(
    order: ToolOrder,
    plan: &ToolPlan,
    start: Option<ToolId>,
    settings: &Settings,
) -> ToolOrderRow {
    let seconds = seconds(settings);
    let (mut change_s, mut flushed_mm3) = (0.0, 0.0);
    let mut current = start.map(u32::from);
    for &tool in plan.layers.iter().flatten() {
        if let Some(from) = current.filter(|from| *from != tool) {
            change_s += seconds[tool as usize];
            flushed_mm3 += settings.flush_mm3(from as usize, tool as usize);
        }
        current = Some(tool);
    }
    ToolOrderRow {
        order: order.name().into(),
        changes: plan.changes,
        change_s,
        flushed_mm3,
        cost_s: plan.cost as f64 / MS,
        bound_s: plan.bound.map(|bound| bound as f64 / MS),
    }
}

/// Gives each layer its tools. What any may print is printed by the first; what needs no tool of its own, by whichever is in
/// use, at the beginning by the first that is used.
pub(crate) fn settle(layers: &mut [LayerPaths], plan: &ToolPlan, start: Option<ToolId>) {
    let mut orders = plan.layers.iter().map(|order| order.iter().map(|&tool| tool as ToolId).collect());
    let mut current = start.or(plan.layers.iter().flatten().next().map(|&tool| tool as ToolId)).unwrap_or(0);
    for layer in layers {
        let own: Vec<ToolId> = orders.next().unwrap_or_default();
        layer.tools = if own.is_empty() { vec![current] } else { own };
        let first = layer.tools.first().copied();
        for path in &mut layer.paths {
            path.tool = path.tool.or(first);
        }
        current = layer.tools.last().copied().unwrap_or(current);
    }
}
