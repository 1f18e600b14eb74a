//! The optimum of small layers by dynamic programming over subsets, for tests to compare with.

use pathwright::geom::Point;
use pathwright::order::{Problem, Shape};
use pathwright::profile::Scope;

/// Least total link length of a problem of at most 16 items, in millimetres. Bellman 1962 and Held & Karp 1962
/// (<https://doi.org/10.1137/0110015>), the state being the set drawn and the pose in which the last was drawn.
pub fn optimum(problem: &Problem) -> f64 {
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
    let mut best = vec![f64::INFINITY; (full + 1) * poses.len()];
    for (p, &(item, enter, _)) in poses.iter().enumerate() {
        if may_follow(problem, 0, None, item) {
            best[(1 << item) * poses.len() + p] = problem.start.map_or(0.0, |start| start.distance_mm(enter));
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
                    *place = place.min(so_far + leave.distance_mm(enter));
                }
            }
        }
    }
    if n == 0 {
        return 0.0;
    }
    let finish = |(p, pose): (usize, &(usize, Point, Point))| {
        best[full * poses.len() + p] + problem.end.map_or(0.0, |end| pose.2.distance_mm(end))
    };
    poses.iter().enumerate().map(finish).fold(f64::INFINITY, f64::min)
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
