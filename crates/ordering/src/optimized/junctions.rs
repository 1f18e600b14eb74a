//! Moving the position where one group ends and the next begins.

use super::end::End;
use super::end::GAIN;
use super::neighbours::{NEAR, Near};
use super::state::Search;
use pathwright_geometry::Random;

/// Farthest gap from a junction that is tried for it.
const REACH: u32 = 500;
/// Nearest continuations of which a kick takes one.
const NEAREST: u32 = 4;

/// The reversal of everything between a junction and a gap on either side of it, so that the walk passes from group
/// to group elsewhere.
#[derive(Clone, Copy, Debug)]
struct Shift {
    from: u32,
    junction: u32,
    to: u32,
}

impl Search<'_> {
    /// Makes the best shift of the junction at a gap between two groups that saves something: a 3-opt move whose stretches
    /// lie in one group each.
    pub fn shift(&mut self, junction: u32) -> bool {
        let Some(groups) = self.joined(junction) else { return false };
        let now = self.walk.gap(junction);
        let (mut best_gain, mut best) = (GAIN, None);
        for right in [false, true] {
            let end = End { gap: junction, right };
            let (near_end, far_end) = (self.walk.node(end), self.walk.node(end.across()));
            for gap in self.gaps_beside(end, groups[usize::from(right)]) {
                let outer = End { gap, right };
                let inner = self.walk.node(outer.across());
                let saved = now + self.walk.gap(gap) - self.walk.link(self.walk.node(outer), near_end);
                self.walk.work += 2;
                if saved <= best_gain {
                    continue;
                }
                let list = self.near(inner, groups[usize::from(!right)]);
                for at in 0..NEAR {
                    let Near { node, least, .. } = self.neighbours.get(list, at);
                    if saved - least <= best_gain {
                        break;
                    }
                    let left = saved - self.walk.link(inner, node);
                    self.walk.work += 1;
                    for node in self.walk.nodes_of(node) {
                        let other = self.walk.end_of(node);
                        if other.right != right || other.gap == junction {
                            continue;
                        }
                        let beyond = self.walk.node(other.across());
                        let mut gain = left + self.walk.gap(other.gap) - self.walk.link(far_end, beyond);
                        self.walk.work += 2;
                        if gain > best_gain {
                            gain -= self.walk.surcharge(self.walk.node(outer), near_end)
                                + self.walk.surcharge(inner, node)
                                + self.walk.surcharge(far_end, beyond);
                        }
                        if gain > best_gain {
                            best_gain = gain;
                            best = Some(Shift { from: gap.min(other.gap), junction, to: gap.max(other.gap) });
                        }
                    }
                }
            }
        }
        best.map(|shift| self.make(shift)).is_some()
    }

    /// Shifts the junction after a group to somewhere else, whatever that costs.
    pub fn kick_junction(&mut self, group: u32, random: &mut Random) {
        let junction = self.walk.span(group).1;
        let Some(groups) = self.joined(junction) else { return };
        let gaps = self.gaps_beside(End { gap: junction, right: false }, group);
        let from = gaps.start + random.below(gaps.end - gaps.start);
        let list = self.near(self.walk.node(End { gap: from, right: true }), groups[1]);
        let Near { node, least, .. } = self.neighbours.get(list, random.below(NEAREST) as usize);
        if least.is_infinite() {
            return;
        }
        let to = self.walk.nodes_of(node).map(|node| self.walk.end_of(node)).find(|end| !end.right);
        if let Some(to) = to {
            self.make(Shift { from, junction, to: to.gap });
        }
    }

    /// The groups before and after a gap, if they differ.
    fn joined(&self, gap: u32) -> Option<[u32; 2]> {
        if gap <= 1 || gap > self.walk.len() {
            return None;
        }
        let groups = [self.walk.group_at(gap - 1), self.walk.group_at(gap)];
        (groups[0] != groups[1]).then_some(groups)
    }

    /// The gaps of a group, on one side of the junction where it begins or ends, that are not too far from it.
    fn gaps_beside(&self, junction: End, group: u32) -> std::ops::Range<u32> {
        let (first, last) = self.walk.span(group);
        if junction.right {
            junction.gap + 1..last.min(junction.gap + REACH) + 1
        } else {
            first.max(junction.gap.saturating_sub(REACH))..junction.gap
        }
    }

    fn make(&mut self, Shift { from, junction, to }: Shift) {
        self.walk.reverse(from, junction - 1);
        self.walk.reverse(junction, to - 1);
        [from, junction, to].into_iter().for_each(|gap| self.touch(gap));
    }
}
