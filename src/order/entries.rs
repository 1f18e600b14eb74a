//! The best directions and entries of consecutive paths together, their order being as it is.

use super::{Problem, Sequence, Shape};
use crate::geom::Point;

/// Vertices of each loop that are considered at a time.
const CANDIDATES: usize = 24;

/// Which vertices of a loop to consider, given where it is entered now.
pub(super) type Choice = fn(&[Point], u32) -> Vec<u32>;

/// A way of drawing a path: [`super::Visit::entry`], and where it begins and ends, in millimetres.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way {
    pub entry: u32,
    pub enter: [f64; 2],
    pub leave: [f64; 2],
}

impl Way {
    /// A loop that is entered and left at a vertex.
    pub fn at(vertices: &[Point], entry: u32) -> Self {
        let place = vertices[entry as usize].mm();
        Self { entry, enter: place, leave: place }
    }
}

/// A way as the last of a walk so far: what the walk costs, and the way of the path before.
struct Reached {
    way: Way,
    cost: f64,
    before: u32,
}

/// The cheapest choice of one way for each path: its cost and the entries. `between` is the cost of the link from one place to
/// another; the walk comes from `start` and goes on to `end`.
///
/// Shortest path through layers of candidates: the *cluster optimisation* of the generalised travelling salesman problem
/// (Fischetti, Salazar & Toth 1997, doi:10.1287/opre.45.3.378). `visited` counts the links looked at. Of equal ways the first.
pub(super) fn cheapest_entries(
    start: [f64; 2],
    paths: impl Iterator<Item = Vec<Way>>,
    end: [f64; 2],
    between: impl Fn([f64; 2], [f64; 2]) -> f64,
    visited: &mut u64,
) -> (f64, Vec<u32>) {
    let mut reached =
        vec![Reached { way: Way { entry: 0, enter: start, leave: start }, cost: 0.0, before: 0 }];
    // Each path's ways stand together in `reached`; the last path's begin here.
    let mut last = 0;
    let cheapest = |ways: &[Reached], place| {
        let mut best = (f64::INFINITY, 0);
        for (at, reached) in ways.iter().enumerate() {
            let cost = reached.cost + between(reached.way.leave, place);
            if cost < best.0 {
                best = (cost, at as u32);
            }
        }
        best
    };
    for ways in paths {
        let from = reached.len();
        *visited += ((from - last) * ways.len()) as u64;
        for way in ways {
            let (cost, before) = cheapest(&reached[last..from], way.enter);
            reached.push(Reached { way, cost, before: before + last as u32 });
        }
        last = from;
    }
    let (cost, best) = cheapest(&reached[last..], end);
    let (mut at, mut entries) = (last + best as usize, Vec::new());
    while at > 0 {
        entries.push(reached[at].way.entry);
        at = reached[at].before as usize;
    }
    entries.reverse();
    (cost, entries)
}

/// Vertices spread over a loop, and the one where it is entered now.
pub(super) fn spread(vertices: &[Point], entry: u32) -> Vec<u32> {
    let step = vertices.len().div_ceil(CANDIDATES);
    let mut entries: Vec<_> = (0..vertices.len() as u32).step_by(step).collect();
    if !(entry as usize).is_multiple_of(step) {
        entries.push(entry);
    }
    entries
}

/// Vertices around the one where a loop is entered now.
pub(super) fn around(vertices: &[Point], entry: u32) -> Vec<u32> {
    let n = vertices.len();
    let from = entry as usize + n - CANDIDATES.min(n) / 2;
    (from..from + CANDIDATES.min(n)).map(|at| (at % n) as u32).collect()
}

/// Enters every loop of a solution where the links are shortest, the order and the directions of open paths being as they are:
/// first at vertices spread over each loop, then at those around the ones found. At most O(24²) per path.
pub(super) fn enter_shortest(
    problem: &Problem,
    start: Option<Point>,
    end: Option<Point>,
    sequence: &mut Sequence,
) {
    let place = |point: Option<Point>| point.map_or([f64::NAN; 2], Point::mm);
    let between = |a: [f64; 2], b: [f64; 2]| {
        let length_mm = (a[0] - b[0]).hypot(a[1] - b[1]);
        if length_mm > 0.0 { length_mm } else { 0.0 }
    };
    for choice in [spread as Choice, around] {
        let ways = sequence.iter().map(|visit| match problem.items[visit.item as usize].shape {
            Shape::Loop(vertices) => {
                choice(vertices, visit.entry).into_iter().map(|entry| Way::at(vertices, entry)).collect()
            }
            Shape::Open(_) => {
                let (enter, leave) = problem.items[visit.item as usize].ends(visit.entry);
                vec![Way { entry: visit.entry, enter: enter.mm(), leave: leave.mm() }]
            }
        });
        let (_, entries) = cheapest_entries(place(start), ways, place(end), between, &mut 0);
        for (visit, entry) in sequence.iter_mut().zip(entries) {
            visit.entry = entry;
        }
    }
}
