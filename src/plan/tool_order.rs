//! Which tool prints when: the tools of each layer, in their order.

use super::blocks::Block;
use crate::motion::MotionSettings;
use crate::order::compare_tools::ToolOrderRow;
use crate::order::tools::{ToolLayer, ToolOrder, ToolPlan, ToolProblem, order_tools};
use crate::profile::Settings;
use crate::toolpath::{LayerPaths, ToolId};

/// Milliseconds in a second, in which changes are weighed.
const MS: f64 = 1000.0;

/// The tools that each block of layers needs, and what it costs to change them. Tools with heaters of their own are hot when their
/// turn comes, and cost nothing for that.
pub(crate) fn problem(
    layers: &[LayerPaths],
    blocks: &[Block],
    start: Option<ToolId>,
    settings: &Settings,
) -> ToolProblem {
    let motion = MotionSettings::new(settings, &[]);
    let block = |block: &Block| {
        let paths = layers[block.clone()].iter().flat_map(|layer| &layer.paths);
        let mut tools: Vec<u32> = paths.filter_map(|path| path.tool).map(u32::from).collect();
        tools.sort_unstable();
        tools.dedup();
        ToolLayer { tools, before: Vec::new() }
    };
    let tools = settings.tools.len();
    let cost = |from: usize, to: usize| {
        let waste_s = settings.tool_change.waste_weight * waste_mm3(from, to, &motion, settings);
        let all_s = change_s(from, to, &motion) + shared_heat_s(from, to, &motion) + waste_s;
        if from == to { 0 } else { ms(all_s) }
    };
    ToolProblem {
        layers: blocks.iter().map(block).collect(),
        change: (0..tools).map(|from| (0..tools).map(|to| cost(from, to)).collect()).collect(),
        loaded: start.map(u32::from),
    }
}

/// How long it takes to change from one tool to another, with taking the filament out and putting the next one in.
fn change_s(from: usize, to: usize, motion: &MotionSettings) -> f64 {
    let [own, next] = [from, to].map(|tool| &motion.tools[tool]);
    let swap_s = if own.swaps() { own.swap.unload_s() + next.swap.load_s() } else { 0.0 };
    next.change_time.0 + swap_s
}

/// What a change flushes and rams, mm³.
fn waste_mm3(from: usize, to: usize, motion: &MotionSettings, settings: &Settings) -> f64 {
    settings.flush_mm3(from, to) + motion.tools[from].swap.rammed_mm3()
}

fn ms(seconds: f64) -> u32 {
    (MS * seconds).round() as u32
}

/// How long a heater that all tools share takes from the temperature of one to a higher one.
fn shared_heat_s(from: usize, to: usize, motion: &MotionSettings) -> f64 {
    let (before, own) = (&motion.tools[from], &motion.tools[to]);
    own.shared_heating_s(before.temperature.nozzle, own.temperature.nozzle)
}

/// The order of the tools of each layer, by a rule.
pub(crate) fn plan(problem: &ToolProblem, order: ToolOrder) -> ToolPlan {
    order_tools(problem, order).expect("tools are those of the settings, and none waits for another")
}

/// What an order comes to.
pub(crate) fn row(
    order: ToolOrder,
    plan: &ToolPlan,
    problem: &ToolProblem,
    motion: &MotionSettings,
    settings: &Settings,
) -> ToolOrderRow {
    let (mut changes_s, mut flushed_mm3) = (0.0, 0.0);
    let mut current = problem.loaded;
    for &tool in plan.layers.iter().flatten() {
        if let Some(from) = current.filter(|from| *from != tool) {
            changes_s += change_s(from as usize, tool as usize, motion);
            flushed_mm3 += waste_mm3(from as usize, tool as usize, motion, settings);
        }
        current = Some(tool);
    }
    ToolOrderRow {
        order: order.name().into(),
        changes: plan.changes,
        change_s: changes_s,
        heat_s: (plan.cost as f64 / MS - changes_s - settings.tool_change.waste_weight * flushed_mm3)
            .max(0.0),
        flushed_mm3,
        cost_s: plan.cost as f64 / MS,
        bound_s: plan.bound.map(|bound| bound as f64 / MS),
    }
}

/// Gives each layer its tools: the last of a block those of the block, the others the first of these. What any may print is printed
/// by the first; what needs no tool of its own, by whichever is in use, at the beginning by the first that is used.
pub(crate) fn settle(layers: &mut [LayerPaths], blocks: &[Block], plan: &ToolPlan, start: Option<ToolId>) {
    let mut orders = plan.layers.iter().map(|order| order.iter().map(|&tool| tool as ToolId).collect());
    let mut current = start.or(plan.layers.iter().flatten().next().map(|&tool| tool as ToolId)).unwrap_or(0);
    for block in blocks {
        let own: Vec<ToolId> = orders.next().unwrap_or_default();
        let own = if own.is_empty() { vec![current] } else { own };
        let [first, last] = [own.first(), own.last()].map(|tool| tool.copied().unwrap_or(current));
        for layer in &mut layers[block.clone()] {
            layer.tools = vec![first];
            for path in &mut layer.paths {
                path.tool = path.tool.or(Some(first));
            }
        }
        layers[block.end - 1].tools = own;
        current = last;
    }
}
