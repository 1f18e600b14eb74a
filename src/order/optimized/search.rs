//! Local search with a work queue, and iterated local search on top of it.

use std::collections::VecDeque;

use super::super::index::Index;
use super::super::precedence::Groups;
use super::super::{Cost, Problem, Sequence, Visit};
use super::neighbours::Neighbours;
use super::random::Random;
use super::walk::{End, Walk};

/// What an improvement must save at least (millimetres or seconds), far above rounding and far below anything
/// that matters, so that the search ends.
pub const GAIN: f64 = 1e-7;
/// Longest stretch that a kick swaps.
const KICK: u32 = 30;
/// Farthest exchange while kicks are repaired: what is farther away does not depend on the kick.
const KICK_REACH: u32 = 1000;

/// A walk and what is needed to improve it.
pub struct Search<'a> {
    pub(super) problem: &'a Problem<'a>,
    pub(super) groups: &'a Groups,
    pub(super) index: Index<'a>,
    pub(super) walk: Walk<'a>,
    pub(super) neighbours: Neighbours,
    /// Exchanges move at most so many items.
    pub(super) reach: u32,
    /// Near groups of each group, where they were asked for.
    pub(super) near_groups: Vec<Vec<u32>>,
    queue: VecDeque<u32>,
    queued: Vec<bool>,
}

impl<'a> Search<'a> {
    /// Begins with a solution. All items must be left in the index, and all groups open.
    pub fn new(
        problem: &'a Problem<'a>,
        groups: &'a Groups,
        index: Index<'a>,
        cost: Cost,
        sequence: &[Visit],
    ) -> Self {
        Self {
            problem,
            groups,
            index,
            walk: Walk::new(problem, groups, cost, sequence),
            neighbours: Neighbours::new(problem),
            reach: u32::MAX,
            near_groups: Vec::new(),
            queue: VecDeque::new(),
            queued: vec![false; problem.items.len()],
        }
    }

    /// The walk as it is now.
    pub fn sequence(&self) -> Sequence {
        self.walk.sequence()
    }

    /// Improves the walk until no move does any more.
    pub fn descend(&mut self) {
        for position in 1..=self.walk.len() {
            self.push(self.walk.item_at(position));
        }
        self.drain();
        self.reenter_chains();
        self.drain();
        self.walk.commit();
    }

    /// Kicks the walk somewhere, repairs it, keeps what is not worse; until `budget` steps are done.
    ///
    /// Iterated local search with segment-local double bridges (Martin, Otto & Felten 1991), local kicks and
    /// undo as in Applegate, Cook & Rohe 2003, doi:10.1287/ijoc.15.1.82.13157.
    pub fn iterate(&mut self, random: &mut Random, budget: u64) {
        let end = self.walk.work + budget;
        self.reach = KICK_REACH;
        while self.walk.work < end {
            self.walk.work += 8;
            if !self.kick(random) {
                continue;
            }
            self.drain();
            if self.walk.is_worse() {
                self.walk.undo();
            } else {
                self.walk.commit();
            }
        }
        self.reach = u32::MAX;
    }

    /// Queues the items on both sides of a gap.
    pub(super) fn touch(&mut self, gap: u32) {
        for position in [gap - 1, gap] {
            let item = self.walk.item_at(position);
            if item < self.walk.len() {
                self.push(item);
            }
        }
    }

    fn push(&mut self, item: u32) {
        if !std::mem::replace(&mut self.queued[item as usize], true) {
            self.queue.push_back(item);
        }
    }

    fn drain(&mut self) {
        while let Some(item) = self.queue.pop_front() {
            self.queued[item as usize] = false;
            if self.improve(item) {
                self.push(item);
            }
        }
    }

    /// Makes one improving move that concerns an item, if there is one.
    fn improve(&mut self, item: u32) -> bool {
        if self.reenter(item) {
            return true;
        }
        let at = self.walk.position(item);
        let group = self.walk.group_at(at);
        let (first, end) = self.walk.span(group);
        let (before, after) = (End { gap: at, right: true }, End { gap: at + 1, right: false });
        (end - first > 1 && (self.exchange(before, group) || self.exchange(after, group)))
            || (at == first && end - first > 1 && self.exchange(before.across(), group))
            || (at + 1 == end && end - first > 1 && self.exchange(after.across(), group))
            || self.reinsert(item)
            || ((at == first || at + 1 == end) && self.move_group(group))
    }

    /// Swaps two neighbouring stretches, of one group or of whole groups.
    fn kick(&mut self, random: &mut Random) -> bool {
        let at = 1 + random.below(self.walk.len());
        let group = self.walk.group_at(at);
        let (first, end) = self.walk.span(group);
        if self.groups.items.len() > 1 && (end - first < 3 || random.below(4) == 0) {
            return self.kick_groups(group, random);
        }
        if end - first < 2 {
            return false;
        }
        let from = at.min(end - 2);
        let middle = from + 1 + random.below(KICK.min(end - from - 1));
        let to = middle + 1 + random.below(KICK.min(end - middle));
        self.walk.swap(from, middle, to, false, false);
        [from, from + (to - middle), to].into_iter().for_each(|gap| self.touch(gap));
        true
    }
}
