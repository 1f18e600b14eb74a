//! Every strategy on layers that nobody would draw, through the checker.

mod order_layer;

use order_layer::{Layer, point};
use pathwright::geom::Point;
use pathwright::order::{Cost, Problem, Run, Shape, TravelTime, check, evaluate, strategy};
use pathwright::profile::{Effort, OrderStrategy, Scope};
use proptest::prelude::*;

/// Layers of so many paths, open, of one point, or closed, in up to six runs.
fn layer(paths: std::ops::Range<usize>) -> impl Strategy<Value = Layer> {
    const REACH: i32 = 5_000_000;
    let path = prop_oneof![
        3 => prop::collection::vec(point(REACH), 2),
        1 => prop::collection::vec(point(REACH), 1),
        2 => prop::collection::vec(point(REACH), 3..40),
    ];
    let runs = prop::collection::btree_set((0..2_u32, 0..3_u32, 0..3_u32), 1..=6);
    let runs = runs.prop_map(|runs| runs.into_iter().collect());
    order_layer::layer(prop::collection::vec(path, paths), runs, REACH)
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

/// The least cost of any walk that keeps precedence, by dynamic programming over (drawn, last item, entry).
fn optimum(problem: &Problem, cost: &Cost) -> f64 {
    let n = problem.items.len();
    let entries = |item: usize| match problem.items[item].shape {
        Shape::Open(_) => 2,
        Shape::Loop(vertices) => vertices.len(),
    };
    let run = |item: usize| problem.runs[problem.items[item].run as usize];
    let may_follow = |drawn: usize, last: Option<usize>, next: usize| {
        let left = |other: &usize| drawn & (1 << other) == 0;
        let same_run = |a: usize, b: usize| problem.items[a].run == problem.items[b].run;
        let same_island = |a: usize, b: usize| (run(a).stage, run(a).island) == (run(b).stage, run(b).island);
        let mut others = (0..n).filter(left);
        others.all(|other| {
            let (a, b) = (run(other), run(next));
            let stage = a.stage >= b.stage;
            if problem.scope == Scope::Layer {
                return stage;
            }
            let rank = !same_island(other, next) || same_run(other, next) || a.rank >= b.rank;
            let interrupts = last.is_some_and(|last| {
                (same_run(other, last) && !same_run(next, last))
                    || (problem.scope == Scope::Island
                        && same_island(other, last)
                        && !same_island(next, last))
            });
            stage && rank && !interrupts
        })
    };
    let mut best = vec![vec![Vec::new(); n]; 1 << n];
    for (drawn, best) in best.iter_mut().enumerate() {
        for (item, best) in best.iter_mut().enumerate() {
            let first = drawn == 1 << item && may_follow(0, None, item);
            let reach = |entry: usize| {
                let enter = problem.items[item].ends(entry as u32).0;
                problem.start.map_or(0.0, |start| cost.link(start, enter))
            };
            *best =
                (0..entries(item)).map(|entry| if first { reach(entry) } else { f64::INFINITY }).collect();
        }
    }
    for drawn in 1usize..1 << n {
        for last in (0..n).filter(|last| drawn & (1 << last) != 0) {
            for next in (0..n).filter(|next| drawn & (1 << next) == 0) {
                if !may_follow(drawn, Some(last), next) {
                    continue;
                }
                for from in 0..entries(last) {
                    let leave = problem.items[last].ends(from as u32).1;
                    for to in 0..entries(next) {
                        let enter = problem.items[next].ends(to as u32).0;
                        let total = best[drawn][last][from] + cost.link(leave, enter);
                        let known = &mut best[drawn | 1 << next][next][to];
                        *known = known.min(total);
                    }
                }
            }
        }
    }
    let ends = (0..n).flat_map(|item| (0..entries(item)).map(move |entry| (item, entry)));
    let totals = ends.map(|(item, entry)| {
        let leave = problem.items[item].ends(entry as u32).1;
        best[(1 << n) - 1][item][entry] + problem.end.map_or(0.0, |end| cost.link(leave, end))
    });
    totals.fold(f64::INFINITY, f64::min)
}

/// Loops of random vertices are far harder than any that a slicer makes, and many costs are near 0 here.
#[test]
fn optimized_finds_the_optimum_of_small_layers() {
    use proptest::strategy::ValueTree;
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    let (mut found, mut cases, mut excess) = (0, 0, 0.0);
    for _ in 0..300 {
        let layer = layer(1..8).new_tree(&mut runner).unwrap().current();
        let problem = layer.problem();
        for cost in costs() {
            let best = optimum(&problem, &cost);
            let sequence = strategy(OrderStrategy::Optimized).solve(&problem, &cost, Effort::High);
            let total = evaluate(&problem, &sequence, &cost);
            assert!(total >= best - 1e-9, "{total} beats the optimum {best} of {layer:?}");
            cases += 1;
            found += usize::from(total <= best + 1e-6);
            excess += if best > 0.0 { total / best - 1.0 } else { 0.0 };
        }
    }
    assert!(found * 100 >= cases * 95, "{found} of {cases}");
    assert!(excess / cases as f64 <= 0.02, "{:.4} on average", excess / cases as f64);
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
