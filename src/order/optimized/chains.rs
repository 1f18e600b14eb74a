//! The best directions and entries of consecutive paths together, their order being as it is.

use super::search::{GAIN, Search};
use super::walk::End;
use crate::geom::Point;

/// Vertices of each loop that are considered at a time.
const CANDIDATES: usize = 24;
/// Paths on either side of one that are entered anew with it.
const BESIDE: u32 = 2;

/// Which vertices of a loop to consider, given where it is entered now.
type Choice = fn(&[Point], u32) -> Vec<u32>;

/// A way of drawing the path at some position.
#[derive(Clone, Copy, Debug)]
struct Way {
    /// Entry of a loop; of an open path, whether it is reversed.
    entry: u32,
    enter: [f64; 2],
    leave: [f64; 2],
    /// Least cost from the start of the chain to having drawn it so, and the way of the path before that takes.
    cost: f64,
    before: usize,
}

impl Search<'_> {
    /// Finds the best directions and entries along the whole walk.
    ///
    /// Shortest path through layers of candidates (the *cluster optimisation* of the generalised travelling
    /// salesman problem, Fischetti, Salazar & Toth 1997, doi:10.1287/opre.45.3.378), first on vertices spread over each
    /// loop, then on those around the ones found. At most O(24²) per path.
    pub fn reenter_all(&mut self) {
        for choice in [spread as Choice, around] {
            self.reenter_chain(1, self.walk.len() + 1, choice);
        }
    }

    /// Finds better directions and entries of the path at a position and of those just before and after it together.
    pub fn reenter_beside(&mut self, at: u32) -> bool {
        let (from, to) = (at.saturating_sub(BESIDE).max(1), (at + BESIDE).min(self.walk.len()) + 1);
        self.reenter_chain(from, to, spread) || self.reenter_chain(from, to, around)
    }

    /// The same for the paths at the positions `from` to `to` − 1.
    fn reenter_chain(&mut self, from: u32, to: u32, choice: Choice) -> bool {
        let now: f64 = (from..=to).map(|gap| self.walk.gap(gap)).sum();
        let start = self.walk.place(self.walk.node(End { gap: from, right: false }));
        let start = Way { entry: 0, enter: start, leave: start, cost: 0.0, before: 0 };
        let mut steps: Vec<Vec<Way>> = vec![vec![start]];
        for at in from..to {
            let mut ways = self.ways(at, choice);
            let last = &steps[steps.len() - 1];
            self.walk.work += (last.len() * ways.len()) as u64;
            for way in &mut ways {
                (way.cost, way.before) = self.cheapest(last, way.enter);
            }
            steps.push(ways);
        }
        let end = self.walk.place(self.walk.node(End { gap: to, right: true }));
        let (cost, mut best) = self.cheapest(&steps[steps.len() - 1], end);
        if cost >= now - GAIN {
            return false;
        }
        for at in (from..to).rev() {
            let way = steps[(at - from) as usize + 1][best];
            let item = self.walk.item_at(at);
            if !self.walk.is_loop(item) {
                if way.entry == 1 {
                    self.walk.reverse(at, at);
                    self.touch(at);
                    self.touch(at + 1);
                }
            } else if way.entry != self.walk.entry(item) {
                self.walk.enter(item, way.entry);
                self.touch(at);
                self.touch(at + 1);
            }
            best = way.before;
        }
        true
    }

    /// The ways of drawing the path at a position that are to be considered.
    fn ways(&self, at: u32, choice: Choice) -> Vec<Way> {
        let item = self.walk.item_at(at);
        let way = |entry, enter, leave| Way { entry, enter, leave, cost: 0.0, before: 0 };
        if let Some(vertices) = self.walk.vertices(item) {
            let at = |entry: u32| vertices[entry as usize].mm();
            return choice(vertices, self.walk.entry(item)).iter().map(|&e| way(e, at(e), at(e))).collect();
        }
        let enter = self.walk.place(self.walk.node(End { gap: at, right: true }));
        let leave = self.walk.place(self.walk.node(End { gap: at + 1, right: false }));
        vec![way(0, enter, leave), way(1, leave, enter)]
    }

    /// The least cost of reaching a place after one of these ways, and which way it is; of equal ones the first.
    fn cheapest(&self, ways: &[Way], place: [f64; 2]) -> (f64, usize) {
        let costs = ways.iter().map(|way| way.cost + self.walk.between(way.leave, place));
        costs
            .enumerate()
            .fold((f64::INFINITY, 0), |best, (way, cost)| if cost < best.0 { (cost, way) } else { best })
    }
}

/// Vertices spread over a loop, and the one where it is entered now.
fn spread(vertices: &[Point], entry: u32) -> Vec<u32> {
    let step = vertices.len().div_ceil(CANDIDATES);
    let mut entries: Vec<_> = (0..vertices.len() as u32).step_by(step).collect();
    if !(entry as usize).is_multiple_of(step) {
        entries.push(entry);
    }
    entries
}

/// Vertices around the one where a loop is entered now.
fn around(vertices: &[Point], entry: u32) -> Vec<u32> {
    let n = vertices.len();
    let from = entry as usize + n - CANDIDATES.min(n) / 2;
    (from..from + CANDIDATES.min(n)).map(|at| (at % n) as u32).collect()
}
