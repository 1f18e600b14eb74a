//! Every strategy on layers that nobody would draw, through the checker.

use pathwright::geom::Point;
use pathwright::order::{Cost, Item, Problem, Run, Shape, TravelTime, check, evaluate, strategy};
use pathwright::profile::{Effort, OrderStrategy, Scope};
use proptest::prelude::*;

/// A layer as plain data, from which problems borrow.
#[derive(Clone, Debug)]
struct Layer {
    /// Run and vertices; two vertices make an open path, others a loop.
    items: Vec<(u32, Vec<Point>)>,
    runs: Vec<Run>,
    scope: Scope,
    start: Option<Point>,
    end: Option<Point>,
}

impl Layer {
    fn problem(&self) -> Problem<'_> {
        let items = self.items.iter().map(|(run, points)| Item {
            run: *run,
            shape: if points.len() == 2 { Shape::Open([points[0], points[1]]) } else { Shape::Loop(points) },
        });
        Problem {
            items: items.collect(),
            runs: self.runs.clone(),
            scope: self.scope,
            start: self.start,
            end: self.end,
        }
    }
}

/// Coordinates from a small range coincide often; from a large one, never.
fn point() -> impl Strategy<Value = Point> {
    prop_oneof![
        (0..4i32, 0..4i32).prop_map(|(x, y)| Point::new(x * 100_000, y * 100_000)),
        (0..5_000_000i32, 0..5_000_000i32).prop_map(|(x, y)| Point::new(x, y)),
    ]
}

fn layer(paths: std::ops::Range<usize>) -> impl Strategy<Value = Layer> {
    let path = (
        0..6usize,
        prop_oneof![
            3 => prop::collection::vec(point(), 2),
            1 => prop::collection::vec(point(), 1),
            2 => prop::collection::vec(point(), 3..40),
        ],
    );
    let runs = prop::collection::vec((0..2u32, 0..3u32, 0..3u32), 6);
    let scope = prop::sample::select(vec![Scope::Layer, Scope::Feature, Scope::Island]);
    let ends = (prop::option::of(point()), prop::option::of(point()));
    (prop::collection::vec(path, paths), runs, scope, ends).prop_map(|(paths, runs, scope, (start, end))| {
        let mut used: Vec<usize> = paths.iter().map(|(run, _)| *run).collect();
        used.sort_unstable();
        used.dedup();
        let number = |run: usize| used.binary_search(&run).unwrap() as u32;
        let items = paths.into_iter().map(|(run, points)| (number(run), points)).collect();
        let runs = used.iter().map(|&run| {
            let (stage, island, rank) = runs[run];
            Run { stage, island, rank }
        });
        Layer { items, runs: runs.collect(), scope, start, end }
    })
}

fn costs() -> [Cost; 2] {
    let time =
        TravelTime { speed_mm_s: 150.0, acceleration_mm_s2: 3000.0, retract_from_mm: 1.5, retract_s: 0.05 };
    [Cost::Length, Cost::Time(time)]
}

fn every_strategy_passes(layer: &Layer) {
    let problem = layer.problem();
    for cost in costs() {
        let solve = |name, effort| {
            let sequence = strategy(name).solve(&problem, &cost, effort);
            assert_eq!(check(&problem, &sequence), Ok(()), "{name:?} {effort:?} {cost:?}");
            evaluate(&problem, &sequence, &cost)
        };
        for &(_, name) in OrderStrategy::ALL {
            solve(name, Effort::Fast);
        }
        let nearest = solve(OrderStrategy::Nearest, Effort::Fast);
        for &(_, effort) in Effort::ALL {
            let optimized = solve(OrderStrategy::Optimized, effort);
            assert!(optimized <= nearest * (1.0 + 1e-12), "{effort:?} {cost:?}: {optimized} > {nearest}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    #[test]
    fn random_layers_pass_the_checker(layer in layer(0..40)) {
        every_strategy_passes(&layer);
    }
}

#[test]
fn a_thousand_identical_segments_pass_the_checker() {
    for &(_, scope) in Scope::ALL {
        let ends = vec![Point::new(0, 0), Point::new(500_000, 0)];
        let layer = Layer {
            items: vec![(0, ends); 1000],
            runs: vec![Run { stage: 1, island: 0, rank: 0 }],
            scope,
            start: Some(Point::new(-7, 3)),
            end: None,
        };
        every_strategy_passes(&layer);
    }
}
