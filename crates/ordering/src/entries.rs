//! The best directions and entries of consecutive paths together, their order being as it is.

use super::cost::LinkCosts;
use super::{LinkKind, Problem, Sequence, Shape};
use pathwright_geometry::{Point, real};

/// Vertices of each loop that are considered at a time.
const CANDIDATES: usize = 12;

/// Vertices that stand for a loop where only its whereabouts matter, and of how many of these one is where less will do.
const SAMPLES: usize = 8;
const COARSER: usize = 2;

/// Some vertices of a loop of this many, spread evenly; the coarse ones are among the others.
pub(super) fn samples(vertices: usize, coarse: bool) -> impl Iterator<Item = u32> {
    let step = vertices.div_ceil(SAMPLES).max(1);
    (0..vertices).step_by(if coarse { COARSER * step } else { step }).map(|entry| entry as u32)
}

/// Which vertices of a loop to consider, given where it is entered now.
#[derive(Clone, Copy, Debug)]
pub(super) enum Sampling {
    /// Vertices spread over the loop, the present one among them.
    Everywhere,
    /// Vertices around the present one.
    Around,
}

impl Sampling {
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

/// One choice of entry and direction for a path: [`super::Visit::entry`], and where it begins and ends, in millimetres.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    pub entry: u32,
    pub enter: [f64; 2],
    pub leave: [f64; 2],
}

impl Candidate {
    /// A loop that is entered and left at a vertex.
    pub fn at(entry: u32, vertex: [f64; 2]) -> Self {
        Self { entry, enter: vertex, leave: vertex }
    }
}

/// Searches for the best entries of consecutive paths: the candidates of each, and the cost of the cheapest walk up to
/// each candidate. Kept from search to search for its buffers.
#[derive(Debug, Default)]
pub(super) struct EntrySearch {
    entry: Vec<u32>,
    leave: [Vec<f64>; 2],
    cost: Vec<f64>,
    /// Which candidate comes before it.
    before: Vec<u32>,
    /// Links from all candidates of the last path to one point.
    links: Vec<f64>,
    /// The candidates of one path.
    here: Vec<Candidate>,
    chosen: Vec<u32>,
}

impl EntrySearch {
    fn begin(&mut self, start: [f64; 2]) {
        self.entry.clear();
        self.leave.iter_mut().for_each(Vec::clear);
        self.cost.clear();
        self.before.clear();
        self.push(Candidate::at(0, start), 0.0, 0);
    }

    fn push(&mut self, candidate: Candidate, cost: f64, before: u32) {
        self.entry.push(candidate.entry);
        self.leave.iter_mut().zip(candidate.leave).for_each(|(axis, at)| axis.push(at));
        self.cost.push(cost);
        self.before.push(before);
    }

    /// The cheapest walk to a point by one of the candidates from `from` on and before `to`: its cost, and the candidate.
    fn cheapest(
        &mut self,
        from: usize,
        to: usize,
        [x, y]: [f64; 2],
        cost: &LinkCosts,
        kind: LinkKind,
    ) -> (f64, u32) {
        let (xs, ys) = (&self.leave[0][from..to], &self.leave[1][from..to]);
        self.links.clear();
        // A link to or from an unknown point (NaN) costs nothing. These two loops are vectorised.
        self.links.extend(xs.iter().zip(ys).map(|(&at_x, &at_y)| {
            let (dx, dy) = (at_x - x, at_y - y);
            real::greater((dx * dx + dy * dy).sqrt(), 0.0)
        }));
        let costs = &self.cost[from..to];
        match cost {
            LinkCosts::Length => self.links.iter_mut().zip(costs).for_each(|(link, cost)| *link += cost),
            LinkCosts::Time(time) => {
                self.links.iter_mut().zip(costs).for_each(|(link, cost)| *link = time.of(*link, kind) + cost);
            }
        }
        let mut best = (f64::INFINITY, 0);
        for (&total, candidate) in self.links.iter().zip(from as u32..) {
            if total < best.0 {
                best = (total, candidate);
            }
        }
        best
    }
}

impl EntrySearch {
    /// The cheapest choice of one candidate for each of `count` paths: its cost, the entries, and how many pairs were looked at.
    /// `candidates` appends those of a path; the walk comes from `start` and continues to `end`, which are NaN if unknown.
    /// `kind` tells what the link to a path leads over, and that to the end.
    ///
    /// Shortest path through layers of candidates: the *cluster optimisation* of the generalised travelling salesman problem
    /// (Fischetti, Salazar & Toth 1997, doi:10.1287/opre.45.3.378). Of equal candidates the first.
    pub fn cheapest_entries(
        &mut self,
        start: [f64; 2],
        count: usize,
        mut candidates: impl FnMut(usize, &mut Vec<Candidate>),
        end: [f64; 2],
        cost: &LinkCosts,
        kind: impl Fn(usize) -> LinkKind,
    ) -> (f64, &[u32], u64) {
        self.begin(start);
        let mut here = std::mem::take(&mut self.here);
        let (mut last, mut pairs) = (0, 0);
        for path in 0..count {
            let from = self.entry.len();
            here.clear();
            candidates(path, &mut here);
            pairs += ((from - last) * here.len()) as u64;
            let kind = kind(path);
            for &candidate in &here {
                let (least, before) = self.cheapest(last, from, candidate.enter, cost, kind);
                self.push(candidate, least, before);
            }
            last = from;
        }
        self.here = here;
        let (total, mut at) = self.cheapest(last, self.entry.len(), end, cost, kind(count));
        self.chosen.clear();
        self.chosen.resize(count, 0);
        for entry in self.chosen.iter_mut().rev() {
            *entry = self.entry[at as usize];
            at = self.before[at as usize];
        }
        (total, &self.chosen, pairs)
    }
}

/// Enters every loop of a solution where the links are shortest, the order and the directions of open paths being as they are:
/// first at vertices spread over each loop, then at those around the ones found. At most O(12²) per path.
pub(super) fn enter_shortest(
    problem: &Problem,
    start: Option<Point>,
    end: Option<Point>,
    sequence: &mut Sequence,
) {
    let coordinates = |point: Option<Point>| point.map_or([f64::NAN; 2], Point::mm);
    let mut search = EntrySearch::default();
    for sampling in [Sampling::Everywhere, Sampling::Around] {
        let candidates = |at: usize, candidates: &mut Vec<Candidate>| {
            let visit = sequence[at];
            let item = problem.items[visit.item as usize];
            match item.shape {
                Shape::Loop(vertices) => {
                    let candidate = |entry| Candidate::at(entry, vertices[entry as usize].mm());
                    candidates.extend(sampling.at(vertices.len(), visit.entry).map(candidate));
                }
                Shape::Open(_) => {
                    let (enter, leave) = item.ends(visit.entry);
                    candidates.push(Candidate { entry: visit.entry, enter: enter.mm(), leave: leave.mm() });
                }
            }
        };
        let (start, end) = (coordinates(start), coordinates(end));
        let (_, entries, _) =
            search.cheapest_entries(start, sequence.len(), candidates, end, &LinkCosts::Length, |_| {
                LinkKind::ACROSS
            });
        for (visit, &entry) in sequence.iter_mut().zip(entries) {
            visit.entry = entry;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_coarse_samples_of_a_loop_are_among_the_fine_ones() {
        for vertices in 1..100 {
            let fine: Vec<u32> = samples(vertices, false).collect();
            assert!(fine.len() <= SAMPLES && samples(vertices, true).all(|entry| fine.contains(&entry)));
        }
    }
}
