//! Every strategy on layers that nobody would draw, through the checker.

use crate::exact::{chained_optimum, cheapest};
use crate::order_layer::{self, Layer, point};
use pathwright::geometry::{Point, Region};
use pathwright::order::{
    Chain, Cost, LayerProblem, PathVisit, Pins, Run, SeamRule, TravelTime, Watch, check, ends_on_path,
    evaluate, strategy,
};
use pathwright::profile::{Effort, OrderSettings, OrderStrategy, Scope, SeamPosition};
use pathwright::toolpath::{IslandId, LayerKind, LayerPaths, Path, Phase, Role, Width};
use pathwright::units::Mm;
use proptest::prelude::*;

/// Layers of so many paths, open, of one point, or closed, in up to six runs.
fn layer(paths: std::ops::Range<usize>) -> impl Strategy<Value = Layer> {
    const REACH: i32 = 5_000_000;
    let path = prop_oneof![
        3 => prop::collection::vec(point(REACH), 2),
        1 => prop::collection::vec(point(REACH), 1),
        2 => prop::collection::vec(point(REACH), 3..40),
    ];
    // Of one layer, and of two that are solved together.
    let runs = prop::collection::btree_set((0..4_u32, 0..3_u32, 0..3_u32), 1..=6);
    let runs = runs.prop_map(|runs| runs.into_iter().collect());
    order_layer::layer(prop::collection::vec(path, paths), runs, REACH)
}

fn costs() -> [Cost; 2] {
    let time = TravelTime {
        speed_mm_s: 150.0,
        acceleration_mm_s2: 3000.0,
        retract_from_mm: 1.5,
        retract_inside_from_mm: 4.0,
        retract_s: 0.05,
        climb_s: 0.06,
        ..TravelTime::default()
    };
    [Cost::Length, Cost::Time(time)]
}

/// Open paths in the runs of the given stages, in whole millimetres/10.
fn lines(paths: &[(u32, [(i32, i32); 2])], stages: std::ops::Range<u32>, start: Option<(i32, i32)>) -> Layer {
    let place = |(x, y)| Point::new(x * 100_000, y * 100_000);
    Layer {
        items: paths.iter().map(|(run, ends)| (*run, ends.map(place).to_vec())).collect(),
        runs: stages.map(|stage| Run { stage, island: 0, layer: 0, rank: 0 }).collect(),
        scope: Scope::Layer,
        start: start.map(place),
        end: None,
    }
}

/// Layers that once were solved wrongly.
#[test]
fn paths_of_no_length_pass_the_checker() {
    every_strategy_passes(&lines(&[(0, [(0, 0); 2])], 0..1, None));
    let twice = [(0, [(0, 0); 2]), (0, [(0, 0); 2]), (1, [(0, 0), (1, 0)])];
    every_strategy_passes(&lines(&twice, 0..2, Some((1, 0))));
}

fn every_strategy_passes(layer: &Layer) {
    every_strategy_passes_at(&[Effort::Fast, Effort::Normal, Effort::High], layer);
}

fn every_strategy_passes_at(efforts: &[Effort], layer: &Layer) {
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
        for &effort in efforts {
            let optimized = solve(OrderStrategy::Optimized, effort);
            assert!(optimized <= nearest * (1.0 + 1e-12), "{effort:?} {cost:?}: {optimized} > {nearest}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, ..ProptestConfig::default() })]

    #[test]
    fn random_layers_pass_the_checker(layer in layer(0..40)) {
        every_strategy_passes(&layer);
    }
}

/// Loops of random vertices are far harder than any that a slicer makes, and many costs are near 0 here.
#[test]
fn optimized_finds_the_optimum_of_small_layers() {
    use proptest::strategy::ValueTree;
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    let (mut found, mut cases, mut excess) = (0, 0, 0.0);
    for _ in 0..100 {
        let layer = layer(1..8).new_tree(&mut runner).unwrap().current();
        let problem = layer.problem();
        for cost in costs() {
            let best = cheapest(&problem, &cost);
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
            runs: vec![Run { stage: 1, island: 0, layer: 0, rank: 0 }],
            scope,
            start: Some(Point::new(-7, 3)),
            end: None,
        };
        every_strategy_passes_at(&[Effort::Fast], &layer);
    }
}

/// The squares of these distances are just below what 64 bits hold.
#[test]
fn paths_from_one_end_of_the_grid_to_the_other_pass_the_checker() {
    const FAR: i32 = 1_000_000_000;
    let at = |x: i32, y: i32| Point::new(x * FAR, y * FAR);
    for &(_, scope) in Scope::ALL {
        let layer = Layer {
            items: vec![
                (0, vec![at(-1, -1), at(1, 1)]),
                (0, vec![at(1, -1), at(-1, 1)]),
                (1, vec![at(-1, 0), at(0, 1), at(1, 0)]),
                (1, vec![at(-1, -1), at(-1, -1)]),
            ],
            runs: [0, 1].map(|rank| Run { stage: 1, island: 0, layer: 0, rank }).to_vec(),
            scope,
            start: Some(at(1, 1)),
            end: None,
        };
        every_strategy_passes(&layer);
    }
}

#[test]
fn runs_without_paths_are_passed_over() {
    for &(_, scope) in Scope::ALL {
        let line = |x| vec![Point::new(x, 0), Point::new(x, 500_000)];
        let run = |rank| Run { stage: 1, island: 0, layer: 0, rank };
        let layer = Layer {
            items: vec![(2, line(0)), (0, line(700_000)), (2, line(300_000))],
            runs: vec![run(0), run(1), run(2)],
            scope,
            start: None,
            end: None,
        };
        every_strategy_passes(&layer);
    }
}

/// Odd nodes come in pairs with a node for the nozzle that is joined to itself: wherever it is, a tour exists.
#[test]
fn the_virtual_segment_leaves_parity_alone() {
    let ends = [(0, 0), (900_000, 100_000), (400_000, 800_000)].map(|(x, y)| Point::new(x, y));
    for paths in 1..=3 {
        for start in [ends[0], ends[2], Point::new(-300_000, 5)] {
            let layer = Layer {
                items: (0..paths).map(|path| (0, vec![ends[path], ends[(path + 1) % 3]])).collect(),
                runs: vec![Run { stage: 1, island: 0, layer: 0, rank: 0 }],
                scope: Scope::Layer,
                start: Some(start),
                end: None,
            };
            let problem = layer.problem();
            for name in [OrderStrategy::Christofides, OrderStrategy::ChristofidesOpen] {
                let sequence = strategy(name).solve(&problem, &Cost::Length, Effort::Fast);
                assert_eq!(check(&problem, &sequence), Ok(()), "{name:?}, {paths} paths from {start:?}");
            }
        }
    }
}

fn path(closed: bool, points: Vec<Point>, rank: u32) -> Path {
    Path {
        role: if closed { Role::Perimeter } else { Role::SolidInfill },
        closed,
        points,
        width: Width::Constant(0.4),
        height_mm: 0.2,
        island: Some(IslandId(0)),
        phase: Phase::Found(rank),
        tool: None,
    }
}

/// Three layers of four squares of 10 mm and a line each, the upper ones a little aside.
fn tower() -> Vec<LayerPaths> {
    let layer = |index: usize| {
        let square = |column: usize| {
            let (x, y) = (15.0 * column as f64 + 0.3 * index as f64, 2.0 * (column % 2) as f64);
            let corner = |dx, dy| Point::from_mm(x + dx, y + dy);
            path(true, vec![corner(0., 0.), corner(10., 0.), corner(10., 10.), corner(0., 10.)], 0)
        };
        let line = path(false, vec![Point::from_mm(20., 30.), Point::from_mm(33., 31.)], 1);
        LayerPaths {
            index,
            top_mm: 0.2 * (index + 1) as f64,
            height_mm: 0.2,
            islands: Vec::new(),
            paths: (0..4).map(square).chain([line]).collect(),
            outline: Region::default(),
            beneath: None,
            kind: LayerKind::Flat,
            entries: Default::default(),
            tools: Vec::new(),
            rams: Vec::new(),
            turn: Default::default(),
        }
    };
    (0..3).map(layer).collect()
}

fn chain(seam: SeamPosition, settings: OrderSettings) -> Chain {
    Chain { settings, cost: Cost::Length, seam, corners: None, origin: None, detours: None }
}

fn pins(seam: SeamPosition, layers: &[LayerPaths]) -> Vec<Pins> {
    let mut rule = SeamRule::new(seam);
    layers.iter().map(|layer| rule.pins(layer)).collect()
}

/// Links of a layer from a place to a place.
fn links_mm(layer: &LayerPaths, sequence: &[PathVisit], start: Option<Point>, end: Option<Point>) -> f64 {
    let mut layer = LayerProblem::new(layer, &None, Scope::Layer);
    (layer.problem.start, layer.problem.end) = (start, end);
    evaluate(&layer.problem, &layer.from_paths(sequence), &Cost::Length)
}

#[test]
fn a_chunk_begins_each_layer_where_the_last_one_ended() {
    let layers = tower();
    let free = pins(SeamPosition::Free, &layers);
    let settings = OrderSettings { strategy: OrderStrategy::Nearest, ..OrderSettings::default() };
    let chain = chain(SeamPosition::Free, settings);
    let sequences = chain.solve_chunk(&layers, &free, None, Watch::default());
    let end = ends_on_path(&layers[0], sequences[0][4]).1;
    assert_eq!(chain.solve_chunk(&layers[1..], &free[1..], Some(end), Watch::default()), sequences[1..]);
}

#[test]
fn an_optimized_layer_ends_where_the_next_one_is() {
    let mut layers = tower();
    let line = |x| path(false, vec![Point::from_mm(x, 0.), Point::from_mm(x, 1.)], 0);
    layers.truncate(2);
    layers[0].paths = vec![line(0.), line(20.)];
    layers[1].paths = vec![line(0.)];
    let free = pins(SeamPosition::Free, &layers);
    // The line at 0 is the nearer one, and yet it is to be the last.
    let start = Some(Point::from_mm(9., 0.));
    let sequences = chain(SeamPosition::Free, OrderSettings::default()).solve_chunk(
        &layers,
        &free,
        start,
        Watch::default(),
    );
    assert_eq!(sequences[0].iter().map(|visit| visit.path).collect::<Vec<_>>(), [1, 0]);
}

/// A tower whose layers have two to five random loops each, and a line.
fn random_tower(runner: &mut proptest::test_runner::TestRunner) -> Vec<LayerPaths> {
    use proptest::strategy::ValueTree;
    let corner = || (0..4_000_000, 0..4_000_000).prop_map(|(x, y)| Point { x, y });
    let rings = prop::collection::vec(prop::collection::vec(corner(), 12), 2..6);
    let layers = prop::collection::vec((rings, [corner(), corner()]), 6);
    let layer = |(index, (rings, line)): (usize, (Vec<Vec<Point>>, [Point; 2]))| {
        let paths = rings.into_iter().map(|ring| path(true, ring, 0)).chain([path(false, line.into(), 1)]);
        LayerPaths { index, paths: paths.collect(), ..tower().swap_remove(0) }
    };
    layers.new_tree(runner).unwrap().current().into_iter().enumerate().map(layer).collect()
}

#[test]
fn with_high_effort_small_layers_end_where_all_those_above_are_best_served() {
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    let (mut found, mut best, mut optima) = (0.0, 0.0, 0);
    for _ in 0..40 {
        let layers = random_tower(&mut runner);
        let free = pins(SeamPosition::Free, &layers);
        let settings =
            OrderSettings { effort: Effort::High, scope: Scope::Layer, ..OrderSettings::default() };
        let orders = chain(SeamPosition::Free, settings).solve_chunk(&layers, &free, None, Watch::default());
        let mut at = None;
        let mut total = 0.0;
        for (layer, order) in layers.iter().zip(&orders) {
            total += links_mm(layer, order, at, None);
            at = order.last().map(|&visit| ends_on_path(layer, visit).1);
        }
        let problems: Vec<_> =
            layers.iter().map(|layer| LayerProblem::new(layer, &None, Scope::Layer).problem).collect();
        let optimum = chained_optimum(&problems, &Cost::Length);
        assert!(total >= optimum - 1e-9, "{total} beats the optimum {optimum}");
        optima += usize::from(total <= optimum + 1e-6);
        (found, best) = (found + total, best + optimum);
    }
    assert!(optima >= 38 && found <= 1.001 * best, "{optima} of 40 optima, {:.4}", found / best - 1.0);
}

#[test]
fn a_join_is_never_dearer_once_both_its_ends_are_known() {
    let layers = tower();
    for seam in [SeamPosition::Free, SeamPosition::Rear] {
        let pins = pins(seam, &layers);
        let chain = chain(seam, OrderSettings::default());
        let sequences = chain.solve_chunk(&layers, &pins, None, Watch::default());
        let end = ends_on_path(&layers[2], sequences[2][0]).0;
        for start in [Point::from_mm(60., 40.), Point::from_mm(-9., 3.), Point::from_mm(25., 5.)] {
            let next = Some((&layers[2], sequences[2].as_slice()));
            let joined = chain.resolve_join(
                &layers[..2],
                &pins[..2],
                sequences[..2].to_vec(),
                next,
                Some(start),
                Watch::default(),
            );
            let cost = |sequences: &[Vec<PathVisit>]| {
                let middle = ends_on_path(&layers[1], sequences[1][0]).0;
                links_mm(&layers[0], &sequences[0], Some(start), Some(middle))
                    + links_mm(&layers[1], &sequences[1], None, Some(end))
            };
            assert!(cost(&joined) <= cost(&sequences) + 1e-9, "{seam:?} from {start:?}");
        }
    }
}

#[test]
fn a_join_keeps_its_seams() {
    let layers = tower();
    let pins = pins(SeamPosition::Rear, &layers);
    let chain = chain(SeamPosition::Rear, OrderSettings::default());
    let sequences = chain.solve_chunk(&layers, &pins, None, Watch::default());
    let joined =
        chain.resolve_join(&layers, &pins, sequences, None, Some(Point::from_mm(60., 40.)), Watch::default());
    for (sequence, pins) in joined.iter().zip(pins.iter().flatten()) {
        let mut loops = sequence.iter().filter(|visit| visit.path != 4);
        assert!(loops.all(|visit| visit.entry == pins[visit.path as usize] && visit.entry > 0));
    }
}

#[test]
fn without_chaining_a_layer_does_not_depend_on_the_one_below() {
    let layers = tower();
    let free = pins(SeamPosition::Free, &layers);
    let settings = OrderSettings { chain: false, ..OrderSettings::default() };
    let chain = chain(SeamPosition::Free, settings);
    let together = chain.solve_chunk(&layers, &free, None, Watch::default());
    let apart = chain.solve_chunk(&layers[2..], &free[2..], Some(Point::from_mm(99., 99.)), Watch::default());
    assert_eq!(together[2..], apart);
    let far = Some(Point::from_mm(9., 9.));
    assert_eq!(
        chain.resolve_join(&layers[..1], &free[..1], together[..1].to_vec(), None, far, Watch::default()),
        together[..1]
    );
}

#[test]
fn a_layer_begins_as_far_from_the_last_one_as_is_asked_for() {
    let layers = tower();
    let free = pins(SeamPosition::Free, &layers);
    for &(_, strategy) in OrderStrategy::ALL {
        let settings = OrderSettings { strategy, layer_distance: Mm(12.0), ..OrderSettings::default() };
        let sequences =
            chain(SeamPosition::Free, settings).solve_chunk(&layers, &free, None, Watch::default());
        for (below, above) in [(0, 1), (1, 2)] {
            let end = ends_on_path(&layers[below], sequences[below][4]).1;
            let begin = ends_on_path(&layers[above], sequences[above][0]).0;
            assert!(end.distance_mm(begin) >= 12.0, "{strategy:?}: {}", end.distance_mm(begin));
        }
    }
}

#[test]
fn pinned_loops_are_entered_at_their_first_vertex() {
    let layers = tower();
    let pinned = pins(SeamPosition::Pinned, &layers);
    for &(_, strategy) in OrderStrategy::ALL {
        let settings = OrderSettings { strategy, ..OrderSettings::default() };
        for sequence in
            chain(SeamPosition::Pinned, settings).solve_chunk(&layers, &pinned, None, Watch::default())
        {
            assert!(sequence.iter().all(|visit| visit.path == 4 || visit.entry == 0), "{strategy:?}");
        }
    }
}

#[test]
fn nearest_seams_are_nearest_to_where_the_nozzle_comes_from() {
    let layers = tower();
    let free = pins(SeamPosition::Nearest, &layers);
    let sequences = chain(SeamPosition::Nearest, OrderSettings::default()).solve_chunk(
        &layers,
        &free,
        None,
        Watch::default(),
    );
    for (layer, sequence) in layers.iter().zip(&sequences) {
        for pair in sequence.windows(2).filter(|pair| pair[1].path != 4) {
            let from = ends_on_path(layer, pair[0]).1;
            let entered = ends_on_path(layer, pair[1]).0;
            let points = &layer.paths[pair[1].path as usize].points;
            assert_eq!(Some(from.distance2(entered)), points.iter().map(|p| from.distance2(*p)).min());
        }
    }
}
