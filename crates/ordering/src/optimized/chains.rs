//! Directions and entries of consecutive paths, chosen together.

use super::super::entries::{Candidate, Sampling};
use super::end::End;
use super::end::GAIN;
use super::state::Search;

/// Paths on either side of one that are entered again with it.
const BESIDE: u32 = 2;

impl Search<'_> {
    /// Finds the best directions and entries at the positions `from` to `to` − 1, first on vertices spread over each loop, then on
    /// those around the ones found.
    pub fn reenter_all(&mut self, from: u32, to: u32) {
        for sampling in [Sampling::Everywhere, Sampling::Around] {
            self.reenter_chain(from, to, sampling);
        }
    }

    /// Finds better directions and entries of the path at a position and of those just before and after it together.
    pub fn reenter_beside(&mut self, at: u32) -> bool {
        let (from, to) = (at.saturating_sub(BESIDE).max(1), (at + BESIDE).min(self.walk.len()) + 1);
        self.reenter_chain(from, to, Sampling::Everywhere) || self.reenter_chain(from, to, Sampling::Around)
    }

    /// The same for the paths at the positions `from` to `to` − 1. Knows of no detours, and leaves those to the other moves.
    fn reenter_chain(&mut self, from: u32, to: u32, sampling: Sampling) -> bool {
        if self.walk.has_detours() {
            return false;
        }
        let mut search = std::mem::take(&mut self.entry_search);
        let now: f64 = (from..=to).map(|gap| self.walk.gap(gap)).sum();
        let walk = &self.walk;
        let start = walk.point(walk.node(End { gap: from, right: false }));
        let end = walk.point(walk.node(End { gap: to, right: true }));
        let candidates = |at: usize, candidates: &mut Vec<Candidate>| {
            self.candidates_at(from + at as u32, sampling, candidates)
        };
        let count = (to - from) as usize;
        let kind = |at: usize| walk.kind_of(from + at as u32);
        let (cost, entries, pairs) =
            search.cheapest_entries(start, count, candidates, end, walk.cost(), kind);
        self.walk.work += pairs;
        let gains = cost < now - GAIN;
        if gains {
            self.enter_as(from, entries);
        }
        self.entry_search = search;
        gains
    }

    /// Draws the paths from a position on as found.
    fn enter_as(&mut self, from: u32, entries: &[u32]) {
        for (at, &entry) in (from..).zip(entries) {
            let item = self.walk.item_at(at);
            if !self.walk.is_loop(item) {
                if entry == 1 {
                    self.walk.reverse(at, at);
                    self.touch(at);
                    self.touch(at + 1);
                }
            } else if entry != self.walk.entry(item) {
                self.walk.enter(item, entry);
                self.touch(at);
                self.touch(at + 1);
            }
        }
    }

    /// Appends the entry candidates of the path at a position; of an open path, entry 1 turns it round.
    fn candidates_at(&self, at: u32, sampling: Sampling, candidates: &mut Vec<Candidate>) {
        let item = self.walk.item_at(at);
        if let Some(vertices) = self.walk.vertices(item) {
            let candidate = |entry| Candidate::at(entry, vertices[entry as usize]);
            candidates.extend(sampling.at(vertices.len(), self.walk.entry(item)).map(candidate));
            return;
        }
        let enter = self.walk.point(self.walk.node(End { gap: at, right: true }));
        let leave = self.walk.point(self.walk.node(End { gap: at + 1, right: false }));
        candidates.extend([
            Candidate { entry: 0, enter, leave },
            Candidate { entry: 1, enter: leave, leave: enter },
        ]);
    }
}
