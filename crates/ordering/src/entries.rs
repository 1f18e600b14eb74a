//! The best directions and entries of consecutive paths together, their order being as it is.

use super::{Cost, Problem, Sequence, Shape};
use pathwright_geometry::Point;

/// Vertices of each loop that are considered at a time.
const CANDIDATES: usize = 12;

/// Vertices that stand for a loop where only its whereabouts matter, and of how many of these one is where less will do.
const SAMPLES: usize = 8;
const COARSER: usize = 2;

/// Some vertices of a loop of so many, spread evenly; the coarse ones are among the others.
pub(super) fn samples(vertices: usize, coarse: bool) -> impl Iterator<Item = u32> {
    let step = vertices.div_ceil(SAMPLES).max(1);
    (0..vertices).step_by(if coarse { COARSER * step } else { step }).map(|entry| entry as u32)
}

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

/// The ways of drawing consecutive paths, and what the cheapest walk up to each costs. Kept from search to search for its
/// buffers.
#[derive(Debug, Default)]
pub(super) struct Ways {
    entry: Vec<u32>,
    leave: [Vec<f64>; 2],
    cost: Vec<f64>,
    /// Which way comes before it.
    before: Vec<u32>,
    /// Links from all ways of the last path to one place.
    links: Vec<f64>,
    /// The ways of one path.
    here: Vec<Way>,
    chosen: Vec<u32>,
}

impl Ways {
    fn begin(&mut self, start: [f64; 2]) {
        self.entry.clear();
        self.leave.iter_mut().for_each(Vec::clear);
        self.cost.clear();
        self.before.clear();
        self.push(Way::at(0, start), 0.0, 0);
    }

    fn push(&mut self, way: Way, cost: f64, before: u32) {
        self.entry.push(way.entry);
        self.leave.iter_mut().zip(way.leave).for_each(|(axis, at)| axis.push(at));
        self.cost.push(cost);
        self.before.push(before);
    }

    /// The cheapest walk to a place by one of the ways from `from` on and before `to`: its cost, and the way.
    fn cheapest(
        &mut self,
        from: usize,
        to: usize,
        [x, y]: [f64; 2],
        cost: &Cost,
        inside: bool,
    ) -> (f64, u32) {
        let (xs, ys) = (&self.leave[0][from..to], &self.leave[1][from..to]);
        self.links.clear();
        // To or from anywhere (not a number) is no way at all. These two loops are vectorised.
        self.links.extend(xs.iter().zip(ys).map(|(&at_x, &at_y)| {
            let (dx, dy) = (at_x - x, at_y - y);
            (dx * dx + dy * dy).sqrt().max(0.0)
        }));
        let costs = &self.cost[from..to];
        match cost {
            Cost::Length => self.links.iter_mut().zip(costs).for_each(|(link, cost)| *link += cost),
            Cost::Time(time) => {
                self.links
                    .iter_mut()
                    .zip(costs)
                    .for_each(|(link, cost)| *link = time.of(*link, inside) + cost);
            }
        }
        let mut best = (f64::INFINITY, 0);
        for (&total, way) in self.links.iter().zip(from as u32..) {
            if total < best.0 {
                best = (total, way);
            }
        }
        best
    }
}

impl Ways {
    /// The cheapest choice of one way for each of `count` paths: its cost, the entries, and how many pairs were looked at.
    /// `ways` appends those of a path; the walk comes from `start` and goes on to `end`; not a number: from or to anywhere.
    /// `inside` says of the link to a path, and to the end, whether it is inside of an island.
    ///
    /// Shortest path through layers of candidates: the *cluster optimisation* of the generalised travelling salesman problem
    /// (Fischetti, Salazar & Toth 1997, doi:10.1287/opre.45.3.378). Of equal ways the first.
    pub fn cheapest_entries(
        &mut self,
        start: [f64; 2],
        count: usize,
        mut ways: impl FnMut(usize, &mut Vec<Way>),
        end: [f64; 2],
        cost: &Cost,
        inside: impl Fn(usize) -> bool,
    ) -> (f64, &[u32], u64) {
        self.begin(start);
        let mut here = std::mem::take(&mut self.here);
        let (mut last, mut pairs) = (0, 0);
        for path in 0..count {
            let from = self.entry.len();
            here.clear();
            ways(path, &mut here);
            pairs += ((from - last) * here.len()) as u64;
            let inside = inside(path);
            for &way in &here {
                let (least, before) = self.cheapest(last, from, way.enter, cost, inside);
                self.push(way, least, before);
            }
            last = from;
        }
        self.here = here;
        let (total, mut at) = self.cheapest(last, self.entry.len(), end, cost, inside(count));
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
    let place = |point: Option<Point>| point.map_or([f64::NAN; 2], Point::mm);
    let mut search = Ways::default();
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
        let (start, end) = (place(start), place(end));
        let (_, entries, _) =
            search.cheapest_entries(start, sequence.len(), ways, end, &Cost::Length, |_| false);
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
