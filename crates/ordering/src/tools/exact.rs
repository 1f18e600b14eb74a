//! The best order of all layers together, by dynamic programming: what it costs least to have printed some layers and to end with
//! a tool. Within a layer the cheapest way through its tools from each to each is needed; layers with the same tools share it.

use super::large;
use super::paths::{From, NEVER, Paths};
use super::problem::{ToolLayer, ToolProblem, Weights};
use std::collections::BTreeMap;

/// Layers with more tools are not solved exactly: 2²⁰ sets of 20 tools take 170 MB.
const MOST: usize = 20;

/// Tools and what comes before what: what the ways through a layer depend on.
type Key = (Vec<u32>, Vec<(u32, u32)>);

/// The ways through the tools of a layer.
struct Ways {
    /// Ascending.
    tools: Vec<u32>,
    /// Weight of a way from each to each, row by row.
    least: Vec<u64>,
    /// What no such way weighs less than.
    bound: Vec<u64>,
    how: How,
}

enum How {
    /// Index of the table, and the set in it.
    Table(usize, usize),
    /// The way from each tool.
    Known(Vec<Option<Vec<u32>>>),
}

/// The ways through all layers.
struct Layers {
    ways: Vec<Ways>,
    tables: Vec<Paths>,
    /// Index of its ways for each layer with tools.
    of: Vec<Option<usize>>,
}

/// Where a layer's way begins and ends, as indices into its tools.
type Choice = (usize, usize);

impl Layers {
    fn new(problem: &ToolProblem, weights: &Weights, most: usize) -> Self {
        let mut keys: BTreeMap<Key, Option<&ToolLayer>> = BTreeMap::new();
        let key_of: Vec<Key> = problem.layers.iter().map(key).collect();
        for (key, layer) in key_of.iter().zip(&problem.layers).filter(|(key, _)| !key.0.is_empty()) {
            keys.insert(key.clone(), Some(layer));
        }
        let (mut tables, mut ways) = (Vec::new(), Vec::new());
        let shared = shared(keys.keys(), most);
        if let Some(tools) = &shared {
            tables.push(Paths::new(tools.clone(), &[], weights));
        }
        for (key, layer) in &keys {
            let tools = key.0.clone();
            let how = match (&shared, layer) {
                (_, Some(layer)) if tools.len() > most => How::Known(
                    tools.iter().map(|&first| Some(large::order(layer, first, weights)?.0)).collect(),
                ),
                (Some(all), _) if key.1.is_empty() => How::Table(0, set(&tools, all)),
                _ => {
                    let pairs: Vec<_> =
                        key.1.iter().map(|&(a, b)| (place(&tools, a), place(&tools, b))).collect();
                    tables.push(Paths::new(tools.clone(), &pairs, weights));
                    How::Table(tables.len() - 1, (1 << tools.len()) - 1)
                }
            };
            let count = tools.len();
            let (mut least, mut bound) = (vec![NEVER; count * count], vec![NEVER; count * count]);
            if let (How::Known(orders), Some(layer)) = (&how, layer) {
                for (first, order) in orders.iter().enumerate() {
                    for last in (0..count).filter(|&last| last != first && order.is_some()) {
                        bound[first * count + last] = large::bound(layer, tools[first], tools[last], weights);
                    }
                    if let Some(last) = order.as_ref().and_then(|order| order.last()) {
                        let found = order.iter().flat_map(|order| order.windows(2));
                        least[first * count + place(&tools, *last)] =
                            found.map(|pair| weights.of(pair[0], pair[1])).sum();
                    }
                }
            }
            ways.push(Ways { tools, least, bound, how });
        }
        let mut layers = Self { of: Vec::new(), ways, tables };
        layers.fill();
        let places: BTreeMap<&Key, usize> = keys.keys().zip(0..).collect();
        layers.of = key_of.iter().map(|key| places.get(key).copied()).collect();
        layers
    }

    /// Weighs the ways that are in tables, one first tool of one table after the other, as each takes much memory.
    fn fill(&mut self) {
        for (t, table) in self.tables.iter().enumerate() {
            for (first, &tool) in table.tools.iter().enumerate() {
                let asked = |ways: &&mut Ways| {
                    matches!(ways.how, How::Table(of, _) if of == t) && ways.tools.contains(&tool)
                };
                let mut from: Option<From> = None;
                for ways in self.ways.iter_mut().filter(asked) {
                    let How::Table(_, set) = ways.how else { continue };
                    let from = from.get_or_insert_with(|| table.from(first));
                    let (row, count) = (place(&ways.tools, tool), ways.tools.len());
                    for (column, &last) in ways.tools.iter().enumerate() {
                        let least = from.least(set, place(&table.tools, last));
                        ways.least[row * count + column] = least;
                        ways.bound[row * count + column] = least;
                    }
                }
            }
        }
    }

    /// The tools of each layer on the ways chosen.
    fn orders(&self, chosen: &[Option<Choice>]) -> Vec<Vec<u32>> {
        // By table and first tool, so that each is made once.
        let mut asked: BTreeMap<(usize, u32), Vec<usize>> = BTreeMap::new();
        let mut orders = vec![Vec::new(); self.of.len()];
        for (layer, choice) in chosen.iter().enumerate() {
            let (Some((first, _)), Some(ways)) = (*choice, self.of[layer].map(|of| &self.ways[of])) else {
                continue;
            };
            match &ways.how {
                How::Known(known) => orders[layer] = known[first].clone().unwrap_or_default(),
                How::Table(table, _) => asked.entry((*table, ways.tools[first])).or_default().push(layer),
            }
        }
        for ((table, first), layers) in asked {
            let table = &self.tables[table];
            let from = table.from(place(&table.tools, first));
            for layer in layers {
                let (Some((_, last)), Some(of)) = (chosen[layer], self.of[layer]) else { continue };
                let ways = &self.ways[of];
                let How::Table(_, set) = ways.how else { continue };
                orders[layer] = from.order(set, place(&table.tools, ways.tools[last]));
            }
        }
        orders
    }
}

/// What it weighs to begin with each tool when layers so far ended with each with a weight, and with which they ended best:
/// the same, where that is as good.
fn begin(ended: &[u64], first: u32, weights: &Weights) -> (u64, u32) {
    let stay = (ended[first as usize], first);
    let from = |loaded: u32| (ended[loaded as usize] + weights.of(loaded, first), loaded);
    let others = (0..weights.tools()).filter(|&loaded| ended[loaded as usize] < NEVER).map(from);
    others.fold(stay, |best, other| if other.0 < best.0 { other } else { best })
}

/// What layers weigh at least by the tool that the last of them ended with.
struct Programme {
    ended: Vec<u64>,
    /// For each layer and each of its tools as the last: the tool loaded before, and the first.
    back: Vec<Vec<(u32, usize)>>,
}

impl Programme {
    fn new(layers: &Layers, loaded: Option<u32>, weights: &Weights, of: impl Fn(&Ways) -> &[u64]) -> Self {
        let mut ended: Vec<u64> = (0..weights.tools())
            .map(|tool| if loaded.is_none_or(|at| at == tool) { 0 } else { NEVER })
            .collect();
        let mut back = Vec::with_capacity(layers.of.len());
        for at in &layers.of {
            let Some(ways) = at.map(|at| &layers.ways[at]) else {
                back.push(Vec::new());
                continue;
            };
            let (count, through) = (ways.tools.len(), of(ways));
            let begun: Vec<(u64, u32)> =
                ways.tools.iter().map(|&first| begin(&ended, first, weights)).collect();
            ended.fill(NEVER);
            let mut from = Vec::with_capacity(count);
            for (last, &tool) in ways.tools.iter().enumerate() {
                let sums = (0..count).map(|first| (begun[first].0 + through[first * count + last], first));
                let (least, first) = sums.min().unwrap_or((NEVER, 0));
                ended[tool as usize] = least.min(NEVER);
                from.push((begun[first].1, first));
            }
            back.push(from);
        }
        Self { ended, back }
    }

    fn least(&self) -> u64 {
        self.ended.iter().copied().min().unwrap_or(0)
    }

    /// The way through each layer that leads to the least.
    fn choices(&self, layers: &Layers) -> Vec<Option<Choice>> {
        let mut chosen = vec![None; self.back.len()];
        let mut tool = (0..self.ended.len()).min_by_key(|&tool| self.ended[tool]).unwrap_or(0) as u32;
        for (layer, back) in self.back.iter().enumerate().rev().filter(|(_, back)| !back.is_empty()) {
            let Some(ways) = layers.of[layer].map(|of| &layers.ways[of]) else { continue };
            let last = place(&ways.tools, tool);
            let (before, first) = back[last];
            chosen[layer] = Some((first, last));
            tool = before;
        }
        chosen
    }
}

/// The best order of all layers, and what none costs less than.
pub(super) fn optimal(problem: &ToolProblem, weights: &Weights) -> (Vec<Vec<u32>>, u64) {
    solve(problem, weights, MOST)
}

fn solve(problem: &ToolProblem, weights: &Weights, most: usize) -> (Vec<Vec<u32>>, u64) {
    let layers = Layers::new(problem, weights, most);
    let found = Programme::new(&layers, problem.loaded, weights, |ways| &ways.least);
    let bound = Programme::new(&layers, problem.loaded, weights, |ways| &ways.bound).least();
    (layers.orders(&found.choices(&layers)), weights.cost(bound))
}

/// The best order of each layer after the tool that the one before ended with.
pub(super) fn layer_by_layer(problem: &ToolProblem, weights: &Weights) -> Vec<Vec<u32>> {
    let layers = Layers::new(problem, weights, MOST);
    let mut loaded = problem.loaded;
    let mut best = |at: &Option<usize>| {
        let ways = &layers.ways[(*at)?];
        let count = ways.tools.len();
        let weight = |k: usize| {
            let arrive = loaded.map_or(0, |loaded| weights.of(loaded, ways.tools[k / count]));
            arrive + ways.least[k]
        };
        let way = (0..count * count).min_by_key(|&k| weight(k))?;
        loaded = Some(ways.tools[way % count]);
        Some((way / count, way % count))
    };
    let chosen: Vec<_> = layers.of.iter().map(&mut best).collect();
    layers.orders(&chosen)
}

fn key(layer: &ToolLayer) -> Key {
    let mut tools = layer.tools.clone();
    tools.sort_unstable();
    let mut before = layer.before.clone();
    before.retain(|(first, second)| tools.contains(first) && tools.contains(second));
    before.sort_unstable();
    before.dedup();
    (tools, before)
}

/// All tools of the layers without pairs, if one table of them is sooner made than one for each set.
fn shared<'a>(keys: impl Iterator<Item = &'a Key>, most: usize) -> Option<Vec<u32>> {
    let sets: Vec<&[u32]> = keys
        .filter(|(tools, before)| before.is_empty() && tools.len() <= most)
        .map(|(tools, _)| &tools[..])
        .collect();
    let mut all: Vec<u32> = sets.concat();
    all.sort_unstable();
    all.dedup();
    let apart: u128 = sets.iter().map(|set| Paths::work(set.len())).sum();
    (all.len() <= most && Paths::work(all.len()) <= apart).then_some(all)
}

/// The bits of some of the tools of a table.
fn set(tools: &[u32], all: &[u32]) -> usize {
    tools.iter().map(|&tool| 1 << place(all, tool)).sum()
}

/// Where a tool stands among ascending ones that contain it.
fn place(tools: &[u32], tool: u32) -> usize {
    tools.partition_point(|&other| other < tool)
}

#[cfg(test)]
mod tests {
    use super::super::{ToolOrder, order_tools};
    use super::*;
    use proptest::prelude::*;

    /// The least cost of all orders of all layers, one after the other.
    fn brute_force(problem: &ToolProblem) -> (u64, u64) {
        fn all(problem: &ToolProblem, so_far: &mut Vec<Vec<u32>>, best: &mut Option<(u64, u64)>) {
            let Some(layer) = problem.layers.get(so_far.len()) else {
                if let Ok((changes, cost)) = problem.evaluate(so_far) {
                    *best = Some(best.map_or((cost, changes), |best| best.min((cost, changes))));
                }
                return;
            };
            permute(&mut layer.tools.clone(), 0, &mut |order| {
                so_far.push(order.to_vec());
                all(problem, so_far, best);
                so_far.pop();
            });
        }
        fn permute(tools: &mut Vec<u32>, from: usize, with: &mut dyn FnMut(&[u32])) {
            if from >= tools.len() {
                return with(tools);
            }
            for k in from..tools.len() {
                tools.swap(from, k);
                permute(tools, from + 1, with);
                tools.swap(from, k);
            }
        }
        let mut best = None;
        all(problem, &mut Vec::new(), &mut best);
        best.expect("some order is allowed")
    }

    /// Up to four layers of up to four of five tools, with costs among which many are equal, and some pairs.
    fn problems(layers: usize, tools: usize) -> impl Strategy<Value = ToolProblem> {
        let layer = (proptest::sample::subsequence((0..5).collect::<Vec<u32>>(), 0..=tools), any::<u16>());
        let layer = layer.prop_map(|(mut tools, seed)| {
            let turned = usize::from(seed) % tools.len().max(1);
            tools.rotate_left(turned);
            // Pairs that follow one order are no circle.
            let pair = |bit: u16, a: u32, b: u32| (seed >> bit & 3 == 3).then_some((a, b));
            let before = [pair(2, 4, 1), pair(4, 1, 3), pair(6, 4, 0), pair(8, 2, 3)];
            ToolLayer { tools, before: before.into_iter().flatten().collect() }
        });
        let costs = prop_oneof![Just(20), 1_u32..4]
            .prop_flat_map(|most| proptest::collection::vec(proptest::collection::vec(0..=most, 5), 5));
        (proptest::collection::vec(layer, 0..=layers), costs, proptest::option::of(0_u32..5))
            .prop_map(|(layers, change, loaded)| ToolProblem { layers, change, loaded })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(3000))]

        #[test]
        fn no_order_costs_less_or_changes_less_often_at_that_cost(problem in problems(3, 4)) {
            let plan = order_tools(&problem, ToolOrder::Optimal).unwrap();
            prop_assert_eq!((plan.cost, plan.changes), brute_force(&problem));
            prop_assert_eq!(plan.bound, Some(plan.cost));
        }

        #[test]
        fn every_rule_is_an_order_that_costs_no_less(problem in problems(6, 5)) {
            let best = order_tools(&problem, ToolOrder::Optimal).unwrap().cost;
            for &(_, order) in ToolOrder::ALL {
                prop_assert!(order_tools(&problem, order).unwrap().cost >= best);
            }
        }

        #[test]
        fn layers_too_large_to_solve_get_an_order_and_a_bound_below_the_best(problem in problems(3, 4)) {
            let weights = problem.weights().unwrap();
            let (layers, bound) = solve(&problem, &weights, 2);
            let best = brute_force(&problem).0;
            prop_assert!(problem.evaluate(&layers).unwrap().1 >= best);
            prop_assert!(bound <= best);
        }

        #[test]
        fn the_order_of_one_layer_is_the_best_after_the_loaded_tool(problem in problems(1, 4)) {
            let plan = order_tools(&problem, ToolOrder::LayerByLayer).unwrap();
            prop_assert_eq!((plan.cost, plan.changes), brute_force(&problem));
        }
    }

    fn layers(layers: &[&[u32]]) -> Vec<ToolLayer> {
        layers.iter().map(|tools| ToolLayer { tools: tools.to_vec(), before: Vec::new() }).collect()
    }

    fn equal_costs(tools: usize) -> Vec<Vec<u32>> {
        vec![vec![10; tools]; tools]
    }

    #[test]
    fn the_last_tool_and_the_next_first_are_decided_together() {
        // Who ends the second layer with 2, the highest, changes once more.
        let problem = ToolProblem {
            layers: layers(&[&[0, 1], &[0, 1, 2], &[0, 1], &[1]]),
            change: equal_costs(3),
            loaded: Some(0),
        };
        let changes = |order| order_tools(&problem, order).unwrap().changes;
        assert_eq!(changes(ToolOrder::Fixed), 6);
        assert_eq!(changes(ToolOrder::LoadedFirst), 5);
        assert_eq!(changes(ToolOrder::Optimal), 4);
    }

    #[test]
    fn twenty_four_tools_on_a_layer_are_ordered_with_a_bound() {
        let tools: Vec<u32> = (0..24).collect();
        let change = |a: u32| (0..24).map(|b: u32| 1 + (a * 7 + b * 13 + a * b) % 97).collect();
        let change: Vec<Vec<u32>> = (0..24).map(change).collect();
        let problem = ToolProblem { layers: layers(&[&tools, &tools[..5], &tools]), change, loaded: Some(3) };
        let plan = order_tools(&problem, ToolOrder::Optimal).unwrap();
        assert!(plan.bound.unwrap() <= plan.cost && plan.cost <= 2 * plan.bound.unwrap(), "{plan:?}");
    }

    #[test]
    fn what_contradicts_itself_is_named() {
        let mut problem =
            ToolProblem { layers: layers(&[&[0], &[1, 0]]), change: equal_costs(2), loaded: None };
        problem.layers[1].before = vec![(0, 1), (1, 0)];
        let text = |problem: &ToolProblem| order_tools(problem, ToolOrder::Optimal).unwrap_err().to_string();
        assert_eq!(text(&problem), "on layer 1 tool 0 must come before itself");
        problem.layers[1] = ToolLayer { tools: vec![0, 2], before: Vec::new() };
        assert_eq!(text(&problem), "there is no tool 2 on layer 1: costs are given for 2");
        problem.layers[1].tools = vec![1, 1];
        assert_eq!(text(&problem), "tool 1 is listed twice on layer 1");
    }
}
