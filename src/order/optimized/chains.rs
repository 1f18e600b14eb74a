//! Directions and entries of consecutive paths, chosen together.

use super::super::entries::{Choice, Way, around, cheapest_entries, spread};
use super::search::{GAIN, Search};
use super::walk::End;

/// Paths on either side of one that are entered anew with it.
const BESIDE: u32 = 2;

impl Search<'_> {
    /// Finds the best directions and entries along the whole walk, first on vertices spread over each loop, then on those around
    /// the ones found.
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
        let walk = &self.walk;
        let start = walk.place(walk.node(End { gap: from, right: false }));
        let end = walk.place(walk.node(End { gap: to, right: true }));
        let ways = (from..to).map(|at| self.ways(at, choice));
        let mut visited = 0;
        let (cost, entries) = cheapest_entries(start, ways, end, |a, b| walk.between(a, b), &mut visited);
        self.walk.work += visited;
        if cost >= now - GAIN {
            return false;
        }
        for (at, entry) in (from..to).zip(entries) {
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
        true
    }

    /// The ways of drawing the path at a position that are to be considered; of an open path, entry 1 turns it round.
    fn ways(&self, at: u32, choice: Choice) -> Vec<Way> {
        let item = self.walk.item_at(at);
        if let Some(vertices) = self.walk.vertices(item) {
            let entries = choice(vertices, self.walk.entry(item));
            return entries.into_iter().map(|entry| Way::at(vertices, entry)).collect();
        }
        let enter = self.walk.place(self.walk.node(End { gap: at, right: true }));
        let leave = self.walk.place(self.walk.node(End { gap: at + 1, right: false }));
        vec![Way { entry: 0, enter, leave }, Way { entry: 1, enter: leave, leave: enter }]
    }
}
