//! Which tool prints when: the tools of each layer, in their order.

use crate::motion::{MotionSettings, drawing_s};
use crate::order::compare_tools::ToolOrderRow;
use crate::order::tools::{ToolHeating, ToolLayer, ToolOrder, ToolPlan, ToolProblem, order_tools};
use crate::profile::Settings;
use crate::toolpath::{LayerPaths, Path, ToolId, bead};
use ordering::{LinkKind, TravelTime};

/// Milliseconds in a second, in which changes are weighed.
const MS: f64 = 1000.0;

/// The tools that each layer of a print needs, and what it costs to change them.
pub(crate) fn problem(layers: &[LayerPaths], start: Option<ToolId>, settings: &Settings) -> ToolProblem {
    let motion = MotionSettings::new(settings, &[]);
    let heating = heating(&motion, settings);
    let travels: Vec<TravelTime> =
        (0..settings.tools.len()).map(|tool| (&*settings.of_tool(tool)).into()).collect();
    let layer = |layer: &LayerPaths| {
        let mut tools: Vec<u32> = layer.paths.iter().filter_map(|path| path.tool).map(u32::from).collect();
        tools.sort_unstable();
        tools.dedup();
        let prints = if heating.is_empty() { Vec::new() } else { prints(layer, &tools, &motion, &travels) };
        ToolLayer { tools, prints, before: Vec::new() }
    };
    let tools = settings.tools.len();
    let cost = |from: usize, to: usize| {
        let waste_s = settings.tool_change.waste_weight * waste_mm3(from, to, &motion, settings);
        let all_s = change_s(from, to, &motion) + shared_heat_s(from, to, &motion) + waste_s;
        if from == to { 0 } else { ms(all_s) }
    };
    ToolProblem {
        layers: layers.iter().map(layer).collect(),
        change: (0..tools).map(|from| (0..tools).map(|to| cost(from, to)).collect()).collect(),
        heating,
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

/// What heating each tool takes, where any cools down while others print.
fn heating(motion: &MotionSettings, settings: &Settings) -> Vec<ToolHeating> {
    if motion.tools.iter().all(|own| own.reheating_s(own.temperature.nozzle) <= 0.0) {
        return Vec::new();
    }
    let area_mm2 = bead::area_mm2(settings.walls.width.0, settings.layer.height.0);
    let heating = |(to, own): (usize, &MotionSettings)| {
        let change_s = own.change_time.0;
        // What is flushed at least, at the tower's speed.
        let others = (0..motion.tools.len()).filter(|from| *from != to);
        let flush_mm3 = others.map(|from| settings.flush_mm3(from, to)).fold(f64::INFINITY, f64::min);
        let flush_s = if flush_mm3.is_finite() { flush_mm3 / (area_mm2 * own.speed.infill.0) } else { 0.0 };
        // The change itself takes a while, too.
        let ahead_s = own.reheating_s(own.temperature.nozzle) - change_s;
        ToolHeating { change: ms(change_s + flush_s), ahead: ms(ahead_s.max(0.0)) }
    };
    motion.tools.iter().enumerate().map(heating).collect()
}

/// How long a heater that all tools share takes from the temperature of one to a higher one.
fn shared_heat_s(from: usize, to: usize, motion: &MotionSettings) -> f64 {
    let (before, own) = (&motion.tools[from], &motion.tools[to]);
    own.shared_heating_s(before.temperature.nozzle, own.temperature.nozzle)
}

/// How long each tool of a layer draws and travels, slowed down to the least time of a layer, milliseconds.
fn prints(layer: &LayerPaths, tools: &[u32], motion: &MotionSettings, travels: &[TravelTime]) -> Vec<u32> {
    let of_tool = |tool: u32| -> f64 {
        let own = layer.paths.iter().filter(|path| path.tool.map(u32::from) == Some(tool));
        let own: Vec<&Path> = own.filter(|path| !path.points.is_empty()).collect();
        let draws_s = own.iter().map(|path| drawing_s(path, layer.index, motion.of_tool(tool as ToolId)));
        let travel = &travels[tool as usize];
        let link_s = |pair: &[&Path]| {
            let [a, b] = [pair[0], pair[1]];
            let end = if a.closed { a.points[0] } else { a.points[a.points.len() - 1] };
            let kind = LinkKind { inside: a.island.is_some() && a.island == b.island, climbs: false };
            travel.of(end.distance_mm(b.points[0]), kind)
        };
        draws_s.sum::<f64>() + own.windows(2).map(link_s).sum::<f64>()
    };
    let seconds: Vec<f64> = tools.iter().map(|tool| of_tool(*tool)).collect();
    let all_s: f64 = seconds.iter().sum();
    let slowed = (motion.cooling.min_layer_time.0 / all_s.max(f64::MIN_POSITIVE)).max(1.0);
    seconds.into_iter().map(|own_s| if own_s > 0.0 { ms(slowed * own_s) } else { 0 }).collect()
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
    settings: &Settings,
) -> ToolOrderRow {
    let motion = MotionSettings::new(settings, &[]);
    let (mut changes_s, mut flushed_mm3) = (0.0, 0.0);
    let mut current = problem.loaded;
    for &tool in plan.layers.iter().flatten() {
        if let Some(from) = current.filter(|from| *from != tool) {
            changes_s += change_s(from as usize, tool as usize, &motion);
            flushed_mm3 += waste_mm3(from as usize, tool as usize, &motion, settings);
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
