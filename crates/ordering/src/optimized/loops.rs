//! Loops: entering them elsewhere, and moving them to another gap and vertex at once.

use super::super::entries::samples;
use super::end::GAIN;
use super::end::{End, NONE};
use super::neighbours::Near;
use super::state::Search;

/// In groups of so few items, all gaps and vertices are tried for a loop.
const FEW: u32 = 6;
/// Nodes near each of the sampled vertices of a loop, beside which a gap is looked for.
const NEAR_SAMPLE: usize = 3;

impl Search<'_> {
    /// Enters a loop at the vertex that makes its two links cheapest. O(vertices).
    pub fn reenter(&mut self, item: u32) -> bool {
        let Some(vertices) = self.walk.vertices(item) else { return false };
        let at = self.walk.position(item);
        let (before, after) = (End { gap: at, right: false }, End { gap: at + 1, right: true });
        let (before, after) = (self.walk.node(before), self.walk.node(after));
        let now = self.walk.gap(at) + self.walk.gap(at + 1);
        if now <= GAIN || vertices.len() == 1 {
            return false;
        }
        let (cost, entry) = self.best_vertex(item, before, after, now - GAIN);
        if cost >= now - GAIN {
            return false;
        }
        self.walk.enter(item, entry);
        self.touch(at);
        self.touch(at + 1);
        true
    }

    /// The vertex of a loop that is cheapest to visit between two nodes if links go straight, and what its two links cost:
    /// detours counted, if the straight links cost less than `most`.
    pub fn best_vertex(&mut self, item: u32, before: u32, after: u32, most: f64) -> (f64, u32) {
        self.walk.work += self.walk.vertices(item).map_or(0, <[_]>::len) as u64;
        let (straight, entry) = self.walk.best_vertex(item, before, after);
        if straight >= most {
            return (straight, entry);
        }
        (straight + self.surcharges(item, entry, before, after), entry)
    }

    /// By how much the links of a loop entered at a vertex between two nodes are more expensive than straight ones.
    fn surcharges(&self, item: u32, entry: u32, before: u32, after: u32) -> f64 {
        let Some(vertices) = self.walk.vertices(item) else { return 0.0 };
        let to = |node| self.walk.surcharge_to(node, item, vertices[entry as usize]);
        to(before) + to(after)
    }

    /// Moves a loop to the gap in its group, and to the vertex, where it costs least.
    ///
    /// Gaps are those beside items that are near to some vertex of the loop.
    pub fn reinsert(&mut self, item: u32) -> bool {
        if !self.walk.is_loop(item) {
            return false;
        }
        let at = self.walk.position(item);
        let group = self.walk.group_at(at);
        let (first, last) = self.walk.span(group);
        if last - first < 2 {
            return false;
        }
        let before = self.walk.node(End { gap: at, right: false });
        let after = self.walk.node(End { gap: at + 1, right: true });
        let mut saved = self.walk.gap(at) + self.walk.gap(at + 1) - self.walk.link(before, after);
        if saved > GAIN {
            saved -= self.walk.surcharge(before, after);
        }
        if saved <= GAIN {
            return false;
        }
        let mut best = (saved - GAIN, NONE, 0);
        if last - first <= FEW {
            for gap in (first..=last).filter(|&gap| gap != at && gap != at + 1) {
                let left = self.walk.node(End { gap, right: false });
                let right = self.walk.node(End { gap, right: true });
                let now = self.walk.gap(gap);
                let (cost, entry) = self.best_vertex(item, left, right, best.0 + now);
                let added = cost - now;
                if added < best.0 {
                    best = (added, gap, entry);
                }
            }
        } else {
            for entry in samples(self.walk.vertices(item).map_or(0, <[_]>::len), true) {
                let list = self.neighbours.of(self.problem, group, item, entry);
                let Some(vertex) = self.walk.vertices(item).map(|vertices| vertices[entry as usize]) else {
                    continue;
                };
                for near in 0..NEAR_SAMPLE {
                    let Near { node, least, .. } = self.neighbours.get(list, near);
                    if least.is_infinite() {
                        break;
                    }
                    let beside = self.walk.position(node / 2);
                    for gap in [beside, beside + 1] {
                        if gap == at || gap == at + 1 || gap.abs_diff(at) > self.reach {
                            continue;
                        }
                        let left = self.walk.node(End { gap, right: false });
                        let right = self.walk.node(End { gap, right: true });
                        let mut added = self.walk.link_to(left, item, vertex)
                            + self.walk.link_to(right, item, vertex)
                            - self.walk.gap(gap);
                        self.walk.work += 3;
                        if added < best.0 {
                            added += self.surcharges(item, entry, left, right);
                        }
                        if added < best.0 {
                            best = (added, gap, entry);
                        }
                    }
                }
            }
        }
        let (added, gap, near) = best;
        if gap == NONE {
            return false;
        }
        let left = self.walk.node(End { gap, right: false });
        let right = self.walk.node(End { gap, right: true });
        let (cost, entry) = self.best_vertex(item, left, right, f64::INFINITY);
        // The vertex that is best for straight links may have a longer route.
        let better = cost - self.walk.gap(gap) <= added;
        self.walk.enter(item, if better { entry } else { near });
        if gap < at {
            self.walk.swap(gap, at, at + 1, false, false);
            [gap, gap + 1, at + 1].into_iter().for_each(|gap| self.touch(gap));
        } else {
            self.walk.swap(at, at + 1, gap, false, false);
            [at, gap - 1, gap].into_iter().for_each(|gap| self.touch(gap));
        }
        true
    }
}
