//! Consecutive loops: the best entries of all of them together.

use super::search::{GAIN, Search};
use super::walk::End;
use crate::geom::Point;

/// Vertices of each loop that are considered at a time.
const CANDIDATES: usize = 24;

/// Loops on either side of a loop that are entered anew with it.
const BESIDE: u32 = 2;

impl Search<'_> {
    /// Finds the best entries of every chain of consecutive loops, the order being as it is.
    ///
    /// Shortest path through layers of candidate vertices (the *cluster optimisation* of the generalised travelling
    /// salesman problem, Fischetti, Salazar & Toth 1997, doi:10.1287/opre.45.3.378), first on vertices spread over each
    /// loop, then on those around the ones found. O(24² per loop).
    pub fn reenter_chains(&mut self) {
        let mut at = 1;
        while at <= self.walk.len() {
            let from = at;
            while self.walk.is_loop(self.walk.item_at(at)) {
                at += 1;
            }
            if at - from > 1 {
                self.reenter_chain(from, at, &spread);
                self.reenter_chain(from, at, &around);
            }
            at += 1;
        }
    }

    /// Finds better entries of a loop and of the loops just before and after it together.
    pub fn reenter_with_neighbours(&mut self, item: u32) -> bool {
        if !self.walk.is_loop(item) {
            return false;
        }
        let at = self.walk.position(item);
        let (mut from, mut to) = (at, at + 1);
        while at - from < BESIDE && self.walk.is_loop(self.walk.item_at(from - 1)) {
            from -= 1;
        }
        while to - at <= BESIDE && self.walk.is_loop(self.walk.item_at(to)) {
            to += 1;
        }
        to - from > 1 && (self.reenter_chain(from, to, &spread) || self.reenter_chain(from, to, &around))
    }

    /// The same for the loops at the positions `from` to `to` − 1.
    fn reenter_chain(&mut self, from: u32, to: u32, candidates: &dyn Fn(&[Point], u32) -> Vec<u32>) -> bool {
        let walk = &mut self.walk;
        let now: f64 = (from..=to).map(|gap| walk.gap(gap)).sum();
        let mut places = vec![walk.place(walk.node(End { gap: from, right: false }))];
        let mut costs = vec![0.0];
        // For each loop, for each candidate: its entry and the best candidate of the loop before.
        let mut steps: Vec<Vec<(u32, usize)>> = Vec::with_capacity((to - from) as usize);
        for at in from..to {
            let item = walk.item_at(at);
            let vertices = walk.vertices(item).unwrap_or_default();
            let entries = candidates(vertices, walk.entry(item));
            let next: Vec<_> = entries.iter().map(|&entry| vertices[entry as usize].mm()).collect();
            let reached: Vec<_> = next
                .iter()
                .map(|&place| cheapest(&costs, places.iter().map(|&before| walk.between(before, place))))
                .collect();
            walk.work += (places.len() * next.len()) as u64;
            steps.push(entries.iter().zip(&reached).map(|(&entry, &(_, before))| (entry, before)).collect());
            costs = reached.into_iter().map(|(cost, _)| cost).collect();
            places = next;
        }
        let end = walk.place(walk.node(End { gap: to, right: true }));
        let (cost, mut best) = cheapest(&costs, places.iter().map(|&before| walk.between(before, end)));
        if cost >= now - GAIN {
            return false;
        }
        for at in (from..to).rev() {
            let (entry, before) = steps[(at - from) as usize][best];
            self.walk.enter(self.walk.item_at(at), entry);
            self.touch(at);
            best = before;
        }
        self.touch(to);
        true
    }
}

/// The least sum of a cost and its link, and which it is; of equal ones the first.
fn cheapest(costs: &[f64], links: impl Iterator<Item = f64>) -> (f64, usize) {
    let sums = costs.iter().zip(links).map(|(cost, link)| cost + link);
    let (best, cost) = sums
        .enumerate()
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .expect("every loop has a vertex to be entered at");
    (cost, best)
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
