//! Bounds by linear programs against the optimum of small layers, by trial of all orders.
#![cfg(feature = "highs")]

use pathwright_geometry::Point;
use pathwright_ordering::{
    Cost, Effort, Item, Optimized, Problem, Run, Scope, Sequence, Shape, Strategy as _, TravelTime, Visit,
    bound, check, evaluate,
};
use proptest::prelude::*;

/// Largest coordinate, in grid units.
const REACH: i32 = 500_000;
/// Sums of a few square roots: far above their rounding.
const ROUNDING_MM: f64 = 1e-9;

/// A layer that owns its points.
#[derive(Clone, Debug)]
struct Layer {
    paths: Vec<(u32, Vec<Point>)>,
    runs: Vec<Run>,
    scope: Scope,
    ends: [Option<Point>; 2],
}

impl Layer {
    /// Its paths: of two points open ones, others loops.
    fn problem(&self) -> Problem<'_> {
        let items = self.paths.iter().map(|(run, points)| Item { run: *run, shape: shape(points) });
        let [start, end] = self.ends;
        Problem { items: items.collect(), runs: self.runs.clone(), scope: self.scope, start, end }
    }
}

fn shape(points: &[Point]) -> Shape<'_> {
    match *points {
        [a, b] => Shape::Open([a, b]),
        _ => Shape::Loop(points),
    }
}

fn point() -> impl Strategy<Value = Point> {
    (-REACH..REACH, -REACH..REACH).prop_map(|(x, y)| Point { x, y })
}

fn layer() -> impl Strategy<Value = Layer> {
    let path = prop_oneof![
        2 => prop::collection::vec(point(), 2),
        1 => prop::collection::vec(point(), 1),
        2 => prop::collection::vec(point(), 3..13),
    ];
    let run = (0..2_u32, 0..2_u32, 0..3_u32);
    let run = run.prop_map(|(stage, island, rank)| Run { stage, island, layer: 0, rank });
    let scope = prop::sample::select(vec![Scope::Layer, Scope::Feature, Scope::Island]);
    let paths = prop::collection::vec((0..3_u32, path), 1..5);
    (paths, prop::collection::vec(run, 3), scope, [prop::option::of(point()), prop::option::of(point())])
        .prop_map(|(paths, all, scope, ends)| used(paths, &all, scope, ends))
}

/// A layer with those runs that have paths.
fn used(mut paths: Vec<(u32, Vec<Point>)>, all: &[Run], scope: Scope, ends: [Option<Point>; 2]) -> Layer {
    let mut used: Vec<u32> = paths.iter().map(|(run, _)| *run).collect();
    used.sort_unstable();
    used.dedup();
    let place = |run: u32| used.partition_point(|&other| other < run) as u32;
    paths.iter_mut().for_each(|(run, _)| *run = place(*run));
    Layer { paths, runs: used.iter().map(|&run| all[run as usize]).collect(), scope, ends }
}

/// A cost that layers of [`REACH`] have on both sides of what is retracted.
fn cost() -> impl Strategy<Value = Cost> {
    let time = TravelTime {
        speed_mm_s: 150.0,
        acceleration_mm_s2: 3000.0,
        stop_s: 0.003,
        retract_from_mm: 1.5,
        retract_inside_from_mm: 3.0,
        retract_s: 0.05,
        climb_s: 0.02,
        ..TravelTime::default()
    };
    prop::sample::select(vec![Cost::Length, Cost::Time(time)])
}

/// The cost of a cheapest order that precedence permits, by trial.
fn optimum(problem: &Problem, cost: &Cost, order: &mut Sequence) -> f64 {
    if order.len() == problem.items.len() {
        let permitted = check(problem, order).is_ok();
        return if permitted { evaluate(problem, order, cost) } else { f64::MAX };
    }
    let mut best = f64::MAX;
    let is_left = |order: &Sequence, item: u32| order.iter().all(|visit| visit.item != item);
    let stage = |path: &Item| problem.runs[path.run as usize].stage;
    let left = (0..).zip(&problem.items).filter(|&(item, _)| is_left(order, item));
    let next = left.map(|(_, path)| stage(path)).min();
    for (item, path) in (0..).zip(&problem.items) {
        if !is_left(order, item) || Some(stage(path)) != next {
            continue;
        }
        let entries = match path.shape {
            Shape::Open(_) => 2,
            Shape::Loop(vertices) => vertices.len() as u32,
        };
        for entry in 0..entries {
            order.push(Visit { item, entry });
            best = best.min(optimum(problem, cost, order));
            order.pop();
        }
    }
    best
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn a_bound_is_not_above_the_optimum(cost in cost(), layer in layer()) {
        let problem = layer.problem();
        let optimum = optimum(&problem, &cost, &mut Vec::new());
        if let Some(bound) = bound::by_program(&problem, &cost, Effort::High) {
            prop_assert!(bound <= optimum + ROUNDING_MM, "{bound} > {optimum}");
        }
    }
}

/// Layers above each other as one.
fn stacked(layers: &[Layer]) -> Layer {
    let mut all = Layer {
        ends: [layers[0].ends[0], layers[layers.len() - 1].ends[1]],
        paths: Vec::new(),
        runs: Vec::new(),
        scope: layers[0].scope,
    };
    for (number, layer) in (0..).zip(layers) {
        let first = all.runs.len() as u32;
        all.runs.extend(layer.runs.iter().map(|run| Run {
            stage: run.stage + 2 * number,
            // No link between layers stays inside an island.
            island: run.island + 2 * number,
            layer: number,
            ..*run
        }));
        all.paths.extend(layer.paths.iter().map(|(run, points)| (run + first, points.clone())));
    }
    all
}

/// A layer of up to `most` paths whose seams are pinned, in up to four runs.
fn pinned(most: usize, scope: Scope) -> impl Strategy<Value = Layer> {
    let path = prop::collection::vec(point(), 1..3);
    let runs = prop::collection::vec((0..5_u32, 0..2_u32, 0..3_u32), 4);
    (prop::collection::vec((0..4_u32, path), 1..=most), runs).prop_map(move |(paths, runs)| {
        let run =
            |(stage, island, rank): (u32, u32, u32)| Run { stage: stage.div_ceil(4), island, layer: 0, rank };
        used(paths, &runs.into_iter().map(run).collect::<Vec<_>>(), scope, [None; 2])
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn a_bound_of_layers_that_are_one_program_is_not_above_the_optimum(
        cost in cost(),
        mut layers in prop::sample::select(vec![Scope::Layer, Scope::Feature, Scope::Feature, Scope::Island])
            .prop_flat_map(|scope| [pinned(3, scope), pinned(3, scope)]),
        start in prop::option::of(point()),
    ) {
        layers[0].ends[0] = start;
        let bound = bound::print(&layers.each_ref().map(Layer::problem), &cost, Effort::High);
        let optimum = optimum(&stacked(&layers).problem(), &cost, &mut Vec::new());
        prop_assert!(bound <= optimum + ROUNDING_MM, "{bound} > {optimum}");
    }
}

/// Squares of 32 vertices in a grid, and a line in each.
fn grid(across: i32) -> Vec<Vec<Point>> {
    let mut paths = Vec::new();
    for k in 0..across * across {
        // Neither in rows nor in columns, so that links differ.
        let (x, y) = (1_000_000 * (k % across) + 17_000 * (k % 7), 900_000 * (k / across) + 23_000 * (k % 5));
        let side = |at: i32| (at.clamp(0, 8) - (at - 16).clamp(0, 8)) * 75_000;
        paths.push((0..32).map(|at| Point { x: x + side(at), y: y + side((at + 24) % 32) }).collect());
        paths.push(vec![Point { x: x + 200_000, y: y + 150_000 }, Point { x: x + 400_000, y: y + 350_000 }]);
    }
    paths
}

#[test]
fn loops_that_may_be_entered_anywhere_are_bounded_within_three_per_cent() {
    let paths = grid(4);
    let problem = Problem::of(paths.iter().map(|points| shape(points)));
    let order = Optimized.solve(&problem, &Cost::Length, Effort::High);
    let found = evaluate(&problem, &order, &Cost::Length);
    let bound = bound::by_program(&problem, &Cost::Length, Effort::High).unwrap_or_default();
    assert!(bound <= found && bound > 0.97 * found, "{bound} of {found}");
}

#[cfg(feature = "serde")]
#[test]
fn an_independent_script_finds_the_same_bound() {
    use std::io::Write as _;
    use std::process::{Command, Stdio};

    let paths = grid(3);
    let mut problem = Problem::of(paths.iter().map(|points| shape(points)));
    problem.start = Some(Point { x: -300_000, y: 0 });
    let certificate = bound::certificate(&problem, Effort::High).expect("there is no precedence");
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/check_certificate.py");
    let run = Command::new("python3").arg(script).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn();
    let Ok(mut script) = run else { return eprintln!("there is no python3: the script was not run") };
    let certificate = serde_json::to_vec(&certificate).unwrap();
    script.stdin.take().unwrap().write_all(&certificate).unwrap();
    let output = script.wait_with_output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
}
