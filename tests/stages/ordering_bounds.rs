//! Lower bounds against the optimum, and Christofides against its guarantee, on thousands of small layers.

use crate::exact::{chained_optimum, cheapest, optimum};
use crate::order_layer::{self, Layer, point};
use pathwright::geometry::Point;
use pathwright::order::{Cost, TravelTime, bound, check, evaluate, strategy};
use pathwright::profile::{Effort, OrderStrategy, Scope};
use proptest::prelude::*;

/// Largest coordinate, in grid units.
const REACH: i32 = 500_000;

/// Layers of up to `most` paths, two sevenths of them pinned and as many free loops, in up to five runs.
fn layer(most: usize) -> impl Strategy<Value = Layer> {
    let path = prop_oneof![
        3 => prop::collection::vec(point(REACH), 2),
        2 => prop::collection::vec(point(REACH), 1),
        2 => prop::collection::vec(point(REACH), 3..11),
    ];
    let runs = prop::collection::vec((0..2_u32, 0..3_u32, 0..3_u32), 5);
    order_layer::layer(prop::collection::vec(path, 0..=most), runs, REACH)
}

/// The same with all runs in one stage, so that those of an island come by rank under `feature` scope and links between them
/// have a direction.
fn ranked(most: usize) -> impl Strategy<Value = Layer> {
    layer(most).prop_map(|mut layer| {
        layer.scope = Scope::Feature;
        layer.runs.iter_mut().for_each(|run| run.stage = 1);
        layer
    })
}

/// How much is spent on a bound.
fn effort() -> impl Strategy<Value = Effort> {
    prop::sample::select(vec![Effort::Normal, Effort::High])
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

/// Sums of a few square roots: far above their rounding, far below a bound that is wrong.
const ROUNDING_MM: f64 = 1e-9;

proptest! {
    #![proptest_config(ProptestConfig { cases: 3000, ..ProptestConfig::default() })]

    #[test]
    fn the_bound_of_a_layer_is_not_above_its_optimum(effort in effort(), cost in cost(), layer in layer(7)) {
        let problem = layer.problem();
        let (bound, optimum) = (bound::layer(&problem, &cost, effort), cheapest(&problem, &cost));
        prop_assert!(bound <= optimum + ROUNDING_MM, "{bound} > {optimum}");
    }

    #[test]
    fn relaxed_walks_are_not_above_the_optimum_and_what_they_find_is_one(effort in effort(), cost in cost(), layer in prop_oneof![layer(7), ranked(7)]) {
        let problem = layer.problem();
        let solved = strategy(OrderStrategy::Nearest).solve(&problem, &cost, Effort::Fast);
        let proof = bound::by_walks(&problem, &solved, &cost, effort);
        let optimum = cheapest(&problem, &cost);
        let rounding = 1e-6 * (problem.items.len() + 1) as f64;
        if let Some(proof) = proof {
            prop_assert!(proof.bound <= optimum + ROUNDING_MM, "{} > {optimum}", proof.bound);
            let better = proof.better.unwrap_or_else(|| solved.clone());
            prop_assert!(check(&problem, &better).is_ok());
            let found = evaluate(&problem, &better, &cost);
            prop_assert!(found <= evaluate(&problem, &solved, &cost) + ROUNDING_MM);
            if found <= proof.bound + rounding {
                prop_assert!(found <= optimum + rounding, "{found} is no optimum, {optimum} is");
            }
        }
    }

    #[test]
    fn the_bound_of_a_layer_whose_links_have_directions_is_not_above_its_optimum(effort in effort(), cost in cost(), layer in ranked(7)) {
        let problem = layer.problem();
        let (bound, optimum) = (bound::layer(&problem, &cost, effort), cheapest(&problem, &cost));
        prop_assert!(bound <= optimum + ROUNDING_MM, "{bound} > {optimum}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, ..ProptestConfig::default() })]

    #[test]
    fn the_bound_of_a_print_is_not_above_its_optimum(effort in effort(), cost in cost(), layers in [layer(5), layer(5), layer(5)]) {
        let problems: Vec<_> = layers.iter().map(Layer::problem).collect();
        let (bound, optimum) = (bound::print(&problems, &cost, effort), chained_optimum(&problems, &cost));
        prop_assert!(bound <= optimum + ROUNDING_MM, "{bound} > {optimum}");
    }

    #[test]
    fn the_bound_of_a_print_whose_links_have_directions_is_not_above_its_optimum(effort in effort(), cost in cost(), layers in [ranked(5), ranked(5), ranked(5)]) {
        let problems: Vec<_> = layers.iter().map(Layer::problem).collect();
        let (bound, optimum) = (bound::print(&problems, &cost, effort), chained_optimum(&problems, &cost));
        prop_assert!(bound <= optimum + ROUNDING_MM, "{bound} > {optimum}");
    }

    #[test]
    fn a_share_holds_wherever_its_layer_is_entered(effort in effort(), cost in cost(), layers in [layer(5).boxed(), ranked(5).boxed()], start in prop::option::of(point(REACH))) {
        let mut problems: Vec<_> = layers.iter().map(Layer::problem).collect();
        let shares = bound::shares(&problems, &cost, effort, |n, chunk| (0..n).map(chunk).collect());
        for (problem, share) in problems.iter_mut().zip(shares) {
            (problem.start, problem.end) = (start, None);
            let (bound, optimum) = (share.layer(&cost, start, None), cheapest(problem, &cost));
            prop_assert!(bound <= optimum + ROUNDING_MM, "{bound} > {optimum}");
        }
    }

    #[test]
    fn a_closed_christofides_tour_is_within_its_guarantee(mut layer in layer(7)) {
        layer.items.iter_mut().filter(|(_, points)| points.len() > 2).for_each(|(_, points)| points.truncate(1));
        layer.scope = Scope::Layer;
        layer.runs.iter_mut().for_each(|run| run.stage = 1);
        layer.start.get_or_insert(Point::new(0, 0));
        layer.end = layer.start;
        let problem = layer.problem();
        let print_mm: f64 = layer.items.iter().map(|(_, points)| points[0].distance_mm(points[points.len() - 1])).sum();
        let tour = strategy(OrderStrategy::Christofides).solve(&problem, &Cost::Length, Effort::Fast);
        let found = evaluate(&problem, &tour, &Cost::Length);
        let best = optimum(&problem);
        prop_assert!(print_mm + found <= 1.5 * (print_mm + best) + 1e-4, "{found} against {best}, {print_mm} drawn");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, ..ProptestConfig::default() })]

    #[test]
    fn the_bound_of_a_print_in_several_chunks_is_not_above_its_optimum(effort in effort(), cost in cost(), layers in prop::collection::vec(layer(2), 30)) {
        let problems: Vec<_> = layers.iter().map(Layer::problem).collect();
        let (bound, optimum) = (bound::print(&problems, &cost, effort), chained_optimum(&problems, &cost));
        prop_assert!(bound <= optimum + ROUNDING_MM, "{bound} > {optimum}");
    }
}
