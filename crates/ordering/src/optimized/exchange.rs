//! Exchanging two or three links within a group.

use super::super::cost::LinkCosts;
use super::end::End;
use super::end::GAIN;
use super::neighbours::Near;
use super::state::Search;

/// Neighbours tried for the second new link of an exchange.
const SECOND: usize = 5;

/// An exchange of links, by the gaps that it opens, ascending.
#[derive(Clone, Copy, Debug)]
pub enum Exchange {
    /// 2-opt: the stretch between two gaps is reversed.
    Two(u32, u32),
    /// 3-opt: the stretches A and B between three gaps …
    ThreeOpt([u32; 3], ThreeOpt),
}

/// … are joined again in one of the four combinations that keep none of the three links.
#[derive(Clone, Copy, Debug)]
pub enum ThreeOpt {
    /// B, A: moves a stretch (Or-opt is the case of a short one).
    Swap,
    /// B reversed, A.
    SwapReverseB,
    /// B, A reversed.
    SwapReverseA,
    /// A reversed, B reversed.
    ReverseBoth,
}

impl Search<'_> {
    /// Makes the best exchange that removes the link at `removed.gap`, links its node at `removed` anew within
    /// `group` (its own, or the one on the gap's other side), and saves something.
    ///
    /// Sequential 3-opt with neighbour lists: Lin & Kernighan 1973, doi:10.1287/opre.21.2.498, as implemented for
    /// large instances by Bentley 1992, doi:10.1287/ijoc.4.4.387. Paths are edges that stay, so each node has one link
    /// and the search tree has half the width it has for cities.
    pub fn exchange(&mut self, removed: End, group: u32) -> bool {
        let Some(exchange) = self.best_exchange(removed, group) else { return false };
        let gaps = match exchange {
            Exchange::Two(from, to) => {
                self.walk.reverse(from, to - 1);
                [from, to, to]
            }
            Exchange::ThreeOpt([x, y, z], kind) => {
                match kind {
                    ThreeOpt::Swap => self.walk.swap(x, y, z, false, false),
                    ThreeOpt::SwapReverseA => self.walk.swap(x, y, z, true, false),
                    ThreeOpt::SwapReverseB => self.walk.swap(x, y, z, false, true),
                    ThreeOpt::ReverseBoth => {
                        self.walk.reverse(x, y - 1);
                        self.walk.reverse(y, z - 1);
                    }
                }
                let middle = if matches!(kind, ThreeOpt::ReverseBoth) { y } else { x + (z - y) };
                [x, middle, z]
            }
        };
        gaps.into_iter().for_each(|gap| self.touch(gap));
        true
    }

    fn best_exchange(&mut self, t2: End, group: u32) -> Option<Exchange> {
        let t1 = t2.across();
        let (node1, node2) = (self.walk.node(t1), self.walk.node(t2));
        let removed = self.walk.link_at(node1);
        if removed <= GAIN {
            return None;
        }
        let (mut best_gain, mut best) = (GAIN, None);
        let first = self.near(node2, group);
        let first = *self.neighbours.list(first);
        let mut work = 0;
        for near in first {
            if near.least >= removed {
                break;
            }
            let added = self.added(node2, near);
            work += 1;
            if added >= removed {
                continue;
            }
            for node3 in self.walk.nodes_of(near.node) {
                work += 2;
                let open = removed - added + self.walk.link_at(node3);
                if open <= best_gain || node3 == node1 || node3 == node2 {
                    continue;
                }
                let t3 = self.walk.end_of(node3);
                if t3.gap.abs_diff(t1.gap) > self.reach {
                    continue;
                }
                let node4 = self.walk.across(node3);
                if t3.right == t2.right {
                    let gain = open - self.walk.link(node4, node1);
                    if gain > best_gain {
                        let dearer = self.walk.surcharge(node2, node3) + self.walk.surcharge(node4, node1);
                        let gain = gain - dearer;
                        if gain > best_gain {
                            best_gain = gain;
                            best = Some(Exchange::Two(t1.gap.min(t3.gap), t1.gap.max(t3.gap)));
                        }
                    }
                }
                if open <= best_gain || self.walk.group_of(node4) != group {
                    continue;
                }
                let second = self.near(node4, group);
                let second = self.neighbours.list(second);
                for &near in &second[..SECOND] {
                    if open - near.least <= best_gain {
                        break;
                    }
                    let left = open - self.added(node4, near);
                    work += 1;
                    if left <= best_gain {
                        continue;
                    }
                    for node5 in self.walk.nodes_of(near.node) {
                        let left = left + self.walk.link_at(node5);
                        work += 2;
                        if left <= best_gain {
                            continue;
                        }
                        let node6 = self.walk.across(node5);
                        let gain = left - self.walk.link(node6, node1);
                        if gain <= best_gain || [node1, node2, node3, node4].contains(&node5) {
                            continue;
                        }
                        let t5 = self.walk.end_of(node5);
                        if t5.gap.abs_diff(t1.gap) > self.reach {
                            continue;
                        }
                        let dearer = self.walk.surcharge(node2, node3)
                            + self.walk.surcharge(node4, node5)
                            + self.walk.surcharge(node6, node1);
                        let gain = gain - dearer;
                        if gain > best_gain
                            && let Some(three) = three([t1, t2, t3, t3.across(), t5, t5.across()])
                        {
                            best_gain = gain;
                            best = Some(three);
                        }
                    }
                }
            }
        }
        self.walk.work += work;
        best
    }

    /// Cost of the link from a node to one in its list.
    #[inline(always)]
    fn added(&self, node: u32, near: Near) -> f64 {
        // Where a loop is entered may be farther away than its nearest sample, and between islands it may cost more. Times
        // step where a travel is retracted: there rounding must be the same everywhere, or there is no end of gains.
        let exact = matches!(self.walk.cost(), LinkCosts::Length) && !self.walk.is_loop(near.node / 2);
        if exact { near.least } else { self.walk.link(node, near.node) }
    }

    /// The list of what lies near a node within a group.
    pub fn near(&mut self, node: u32, group: u32) -> usize {
        let item = node / 2;
        if item as usize >= self.problem.items.len() {
            self.walk.work += 16;
            return self.neighbours.near(group, self.walk.point(node));
        }
        let entry = if self.walk.is_loop(item) { self.walk.entry(item) } else { node % 2 };
        if self.walk.group_of(node) == group {
            self.neighbours.of(self.problem, group, item, entry)
        } else {
            self.neighbours.in_other(self.problem, group, item, entry)
        }
    }
}

/// The exchange that removes the links t1–t2, t3–t4, t5–t6 and adds t2–t3, t4–t5, t6–t1, if it leaves one walk.
fn three(t: [End; 6]) -> Option<Exchange> {
    let mut gaps = [t[0].gap, t[2].gap, t[4].gap];
    gaps.sort_unstable();
    let [x, y, z] = gaps;
    let partner = |end: End| {
        let at = t.iter().position(|&other| other == end)?;
        Some(t[[5, 2, 1, 4, 3, 0][at]])
    };
    let (left, right) = (|gap| End { gap, right: false }, |gap| End { gap, right: true });
    let (first, last) = (partner(left(x))?, partner(right(z))?);
    let kind = if first == right(y) && last == left(y) {
        ThreeOpt::Swap
    } else if first == right(y) && last == right(x) {
        ThreeOpt::SwapReverseA
    } else if first == left(z) && last == left(y) {
        ThreeOpt::SwapReverseB
    } else if first == left(y) && last == right(y) {
        ThreeOpt::ReverseBoth
    } else {
        return None;
    };
    Some(Exchange::ThreeOpt(gaps, kind))
}
