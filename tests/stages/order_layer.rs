//! Layers as plain data, for tests that make them up.

use pathwright::geometry::Point;
use pathwright::order::Run;
use pathwright::profile::Scope;
use proptest::prelude::*;

pub use crate::support::cases::shapes::Layer;

/// A point on a coarse grid, where points coincide often and many links are equal, or anywhere below `reach`.
pub fn point(reach: i32) -> impl Strategy<Value = Point> {
    prop_oneof![
        (0..4_i32, 0..4_i32).prop_map(|(x, y)| Point::new(x * 100_000, y * 100_000)),
        (0..reach, 0..reach).prop_map(|(x, y)| Point::new(x, y)),
    ]
}

/// Layers of the given paths, each in one of `runs` (stage, island, rank), of which those without a path are left out.
/// Start and end are known or not.
pub fn layer(
    paths: impl Strategy<Value = Vec<Vec<Point>>>,
    runs: impl Strategy<Value = Vec<(u32, u32, u32)>>,
    reach: i32,
) -> impl Strategy<Value = Layer> {
    let scope = prop::sample::select(vec![Scope::Layer, Scope::Feature, Scope::Island]);
    let ends = (prop::option::of(point(reach)), prop::option::of(point(reach)));
    let choices = prop::collection::vec(any::<prop::sample::Index>(), 64);
    (paths, choices, runs, scope, ends).prop_map(|(paths, choices, runs, scope, (start, end))| {
        let chosen: Vec<usize> =
            (0..paths.len()).map(|path| choices[path % choices.len()].index(runs.len())).collect();
        let mut used = chosen.clone();
        used.sort_unstable();
        used.dedup();
        let number = |run: usize| used.binary_search(&run).expect("listed") as u32;
        let items = paths.into_iter().zip(&chosen).map(|(points, &run)| (number(run), points)).collect();
        // Two stages to a layer, as in a print.
        let run = |&run: &usize| {
            let (stage, island, rank) = runs[run];
            Run { stage, island, layer: stage / 2, rank }
        };
        Layer { items, runs: used.iter().map(run).collect(), scope, start, end }
    })
}
