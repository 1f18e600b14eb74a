//! The best directions and entries of consecutive paths together, their order being as it is.

use super::{Problem, Sequence, Shape};
use crate::geom::Point;

/// Vertices of each loop that are considered at a time.
const CANDIDATES: usize = 24;

/// Which vertices of a loop to consider, given where it is entered now.
#[derive(Clone, Copy, Debug)]
pub(super) enum Look {
    /// Vertices spread over the loop, the present one among them.
    Everywhere,
    /// Vertices around the present one.
    Around,
}

impl Look {
    /// Indices of the vertices to consider among `count`.
    pub fn at(self, count: usize, entry: u32) -> impl Iterator<Item = u32> {
        let (from, step) = match self {
            Self::Everywhere => (entry as usize, count.div_ceil(CANDIDATES)),
            Self::Around => (entry as usize + count - CANDIDATES.min(count) / 2, 1),
        };
        let some = count.div_ceil(step).min(CANDIDATES);
        (0..some).map(move |at| ((from + at * step) % count) as u32)
    }
}

/// A way of drawing a path: [`super::Visit::entry`], and where it begins and ends, in millimetres.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way {
    pub entry: u32,
    pub enter: [f64; 2],
    pub leave: [f64; 2],
}

impl Way {
    /// A loop that is entered and left at a vertex.
    pub fn at(entry: u32, vertex: [f64; 2]) -> Self {
        Self { entry, enter: vertex, leave: vertex }
    }
}

/// The cheapest choice of one way for each of `count` paths: its cost and the entries. `ways` appends those of a path;
/// `between` is the cost of the link from one place to another; the walk comes from `start` and goes on to `end`.
///
/// Shortest path through layers of candidates: the *cluster optimisation* of the generalised travelling salesman problem
/// (Fischetti, Salazar & Toth 1997, doi:10.1287/opre.45.3.378). Of equal ways the first. The last value counts pairs.
pub(super) fn cheapest_entries(
    start: [f64; 2],
    count: usize,
    mut ways: impl FnMut(usize, &mut Vec<Way>),
    end: [f64; 2],
    between: impl Fn([f64; 2], [f64; 2]) -> f64,
) -> (f64, Vec<u32>, u64) {
    let mut all = vec![Way { entry: 0, enter: start, leave: start }];
    // For each way, what the walk up to it costs, and which way comes before it.
    let (mut cost, mut before) = (vec![0.0], vec![0_u32]);
    let cheapest = |all: &[Way], cost: &[f64], from: usize, to: usize, place| {
        let mut best = (f64::INFINITY, 0);
        for at in from..to {
            if cost[at] < best.0 {
                let total = cost[at] + between(all[at].leave, place);
                if total < best.0 {
                    best = (total, at as u32);
                }
            }
        }
        best
    };
    let (mut last, mut pairs) = (0, 0);
    for path in 0..count {
        let from = all.len();
        ways(path, &mut all);
        pairs += ((from - last) * (all.len() - from)) as u64;
        for at in from..all.len() {
            let (least, way) = cheapest(&all, &cost, last, from, all[at].enter);
            cost.push(least);
            before.push(way);
        }
        last = from;
    }
    let (total, mut at) = cheapest(&all, &cost, last, all.len(), end);
    let mut entries = vec![0; count];
    for entry in entries.iter_mut().rev() {
        *entry = all[at as usize].entry;
        at = before[at as usize];
    }
    (total, entries, pairs)
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
    for look in [Look::Everywhere, Look::Around] {
        let ways = |at: usize, ways: &mut Vec<Way>| {
            let visit = sequence[at];
            let item = problem.items[visit.item as usize];
            match item.shape {
                Shape::Loop(vertices) => {
                    let way = |entry| Way::at(entry, vertices[entry as usize].mm());
                    ways.extend(look.at(vertices.len(), visit.entry).map(way));
                }
                Shape::Open(_) => {
                    let (enter, leave) = item.ends(visit.entry);
                    ways.push(Way { entry: visit.entry, enter: enter.mm(), leave: leave.mm() });
                }
            }
        };
        let (_, entries, _) = cheapest_entries(place(start), sequence.len(), ways, place(end), between);
        for (visit, entry) in sequence.iter_mut().zip(entries) {
            visit.entry = entry;
        }
    }
}
