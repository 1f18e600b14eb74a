//! The optimum of small layers by dynamic programming over subsets, for tests to compare with.

use pathwright::geometry::Point;
use pathwright::order::{Cost, LinkKind, Problem, Shape};
use pathwright::profile::Scope;

/// Least total link length of a problem of at most 16 items, in millimetres.
pub fn optimum(problem: &Problem) -> f64 {
    chained_optimum(std::slice::from_ref(problem), &Cost::Length)
}

/// Least total cost of the links of a problem of at most 16 items.
pub fn cheapest(problem: &Problem, cost: &Cost) -> f64 {
    let arrive = |at: Point| problem.start.map_or(0.0, |start| cost.of(start.distance_mm(at), LinkKind::UP));
    let leave = |(so_far, at): (f64, Point)| {
        so_far + problem.end.map_or(0.0, |end| cost.of(at.distance_mm(end), LinkKind::UP))
    };
    let ends = last_poses(problem, cost, arrive);
    if problem.items.is_empty() { 0.0 } else { ends.into_iter().map(leave).fold(f64::INFINITY, f64::min) }
}

/// Least total cost of the links of a print: each layer starts where the one before ended, the first at its start, and the
/// last leads to its end, where these are known. Layers without items are passed over.
pub fn chained_optimum(layers: &[Problem], cost: &Cost) -> f64 {
    let link = |from: Point, to: Point| cost.of(from.distance_mm(to), LinkKind::UP);
    let layers: Vec<_> = layers.iter().filter(|layer| !layer.items.is_empty()).collect();
    let mut ends: Option<Vec<(f64, Point)>> =
        layers.first().and_then(|first| first.start).map(|p| vec![(0.0, p)]);
    for layer in &layers {
        let arrive = |at: Point| {
            let costs = ends.iter().flatten().map(|&(so_far, from)| so_far + link(from, at));
            if ends.is_some() { costs.fold(f64::INFINITY, f64::min) } else { 0.0 }
        };
        ends = Some(last_poses(layer, cost, arrive));
    }
    let end = layers.last().and_then(|last| last.end);
    let leave = |&(so_far, at): &(f64, Point)| so_far + end.map_or(0.0, |end| link(at, end));
    ends.map_or(0.0, |ends| ends.iter().map(leave).fold(f64::INFINITY, f64::min))
}

/// Every state in which everything is drawn: least length so far, and where it ends. Bellman 1962 and Held & Karp 1962
/// (<https://doi.org/10.1137/0110015>), the state being the set drawn and the pose in which the last was drawn.
fn last_poses(problem: &Problem, cost: &Cost, arrive: impl Fn(Point) -> f64) -> Vec<(f64, Point)> {
    let n = problem.items.len();
    assert!(n <= 16, "2^n states");
    let poses: Vec<(usize, Point, Point)> = (0..n)
        .flat_map(|item| {
            let entries = match problem.items[item].shape {
                Shape::Open(_) => 2,
                Shape::Loop(vertices) => vertices.len() as u32,
            };
            (0..entries).map(move |entry| (item, entry))
        })
        .map(|(item, entry)| {
            let (enter, leave) = problem.items[item].ends(entry);
            (item, enter, leave)
        })
        .collect();
    let full = (1_usize << n) - 1;
    let kind = |from: usize, to: usize| {
        let [from, to] = [from, to].map(|item| &problem.runs[problem.items[item].run as usize]);
        LinkKind::between(from, to)
    };
    let mut best = vec![f64::INFINITY; (full + 1) * poses.len()];
    for (p, &(item, enter, _)) in poses.iter().enumerate() {
        if may_follow(problem, 0, None, item) {
            best[(1 << item) * poses.len() + p] = arrive(enter);
        }
    }
    for set in 1..full {
        for (p, &(last, _, leave)) in poses.iter().enumerate() {
            let so_far = best[set * poses.len() + p];
            if so_far == f64::INFINITY {
                continue;
            }
            for (q, &(item, enter, _)) in poses.iter().enumerate() {
                if set >> item & 1 == 0 && may_follow(problem, set, Some(last), item) {
                    let place = &mut best[(set | 1 << item) * poses.len() + q];
                    *place = place.min(so_far + cost.of(leave.distance_mm(enter), kind(last, item)));
                }
            }
        }
    }
    poses.iter().enumerate().map(|(p, pose)| (best[full * poses.len() + p], pose.2)).collect()
}

/// Whether precedence lets `item` come when exactly the items of `set` have been drawn, `last` the last of them.
fn may_follow(problem: &Problem, set: usize, last: Option<usize>, item: usize) -> bool {
    let run = |item: usize| problem.runs[problem.items[item].run as usize];
    let left = |wanted: &dyn Fn(usize) -> bool| {
        (0..problem.items.len()).any(|other| set >> other & 1 == 0 && wanted(other))
    };
    let next = run(item);
    if left(&|other| run(other).stage < next.stage) {
        return false;
    }
    if problem.scope == Scope::Layer {
        return true;
    }
    let island = |item: usize| (run(item).stage, run(item).island);
    let same_run = |a: usize, b: usize| problem.items[a].run == problem.items[b].run;
    if left(&|other| island(other) == island(item) && run(other).rank < next.rank) {
        return false;
    }
    last.is_none_or(|last| {
        (same_run(last, item) || !left(&|other| same_run(last, other)))
            && (problem.scope == Scope::Feature
                || island(last) == island(item)
                || !left(&|other| island(other) == island(last)))
    })
}
