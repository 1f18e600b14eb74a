//! Local search with a work queue, and iterated local search on top of it.

use std::collections::VecDeque;
use std::ops::Range;

use super::super::entries::EntrySearch;
use super::super::greedy::Fragments;
use super::super::index::Index;
use super::super::precedence::{Frontier, Groups};
use super::super::{Cost, Nearest, Problem, Sequence, Visit, Watch};
use super::end::End;
use super::gaps::Gaps;
use super::neighbours::Neighbours;
use super::start::start;
use super::state::Search;
use super::vicinity::Vicinity;
use super::walk::Walk;
use crate::options::Scope;
use pathwright_geometry::Point;
use pathwright_geometry::Random;

/// Longest stretch that a kick swaps.
const KICK: u32 = 20;
/// Farthest exchange while kicks are repaired: what is farther away does not depend on the kick.
const KICK_REACH: u32 = 1000;
/// One kick in this many shifts a junction.
const SHIFT: u32 = 4;
/// Paths that are kicked before the next this many are.
const WINDOW: u32 = 2000;

/// Kicks end early when one step in this many, one after the other, found nothing better.
const PATIENCE: u64 = 4;

/// Steps between two looks of who watches, some milliseconds.
const LOOK: u64 = 100_000;

impl<'a> Search<'a> {
    /// Begins with a walk through nothing.
    pub fn new(
        problem: &'a Problem<'a>,
        groups: &'a Groups,
        cost: Cost,
        few: usize,
        watch: Watch<'a>,
    ) -> Self {
        Self {
            problem,
            groups,
            walk: Walk::new(problem, groups, cost),
            neighbours: Neighbours::new(problem, groups, cost),
            reach: u32::MAX,
            vicinity: Vicinity::new(problem, groups),
            few,
            complete: false,
            queue: VecDeque::new(),
            queued: vec![false; 2 * problem.items.len()],
            watch,
            next_look: LOOK,
            gaps: Gaps::default(),
            index: None,
            entry_search: EntrySearch::default(),
        }
    }

    /// The solution of [`Nearest`].
    pub fn nearest(&mut self) -> Sequence {
        let index = match &mut self.index {
            Some(index) => {
                index.restore();
                index
            }
            none => none.insert(Index::new(self.problem, self.groups)),
        };
        Nearest::walk(self.problem, Frontier::new(self.groups), self.problem.start, index)
    }

    /// The walk as it is now.
    pub fn sequence(&self) -> Sequence {
        self.walk.sequence()
    }

    /// Goes through all items, stage by stage, each from where the last one ended.
    pub fn begin(&mut self) {
        let mut fragments = Fragments::new(self.problem);
        let mut first = 0;
        for positions in self.groups.stages() {
            self.append_stage(first..first + positions.len(), &mut fragments);
            first += positions.len();
        }
    }

    /// Goes on through all items of a stage (its groups), and improves the walk until no move does any more.
    fn append_stage(&mut self, stage: Range<usize>, fragments: &mut Fragments) {
        let (from, at) = (self.walk.len() + 1, self.at());
        // Fragments leave less to improve; but where runs must not be mixed, choosing the next run by the nearest of its ends
        // matters more, and nearest begins lower.
        let visits = match self.problem.scope {
            Scope::Layer => start(self.problem, self.groups, stage, at, &mut self.neighbours, fragments),
            Scope::Feature | Scope::Island => {
                let index = self.index.get_or_insert_with(|| Index::new(self.problem, self.groups));
                Nearest::walk(self.problem, Frontier::within(self.groups, stage), at, index)
            }
        };
        self.walk.append(&visits);
        let to = self.walk.len() + 1;
        (from..=to).for_each(|gap| self.touch(gap));
        self.drain();
        self.reenter_all(from, to);
        self.drain();
        self.walk.commit();
    }

    /// Goes on through all items as a solution does.
    pub fn take_up(&mut self, sequence: &Sequence) {
        self.walk.append(sequence);
    }

    /// Extends the walk to its required end and improves the links between stages.
    pub fn end(&mut self) {
        self.finish(|walk, gap| gap > walk.len() || walk.group_at(gap - 1) != walk.group_at(gap));
    }

    /// Enters all paths where that is best for the whole walk, and goes on from there.
    pub fn enter_best(&mut self) {
        self.reenter_all(1, self.walk.len() + 1);
        self.drain();
        self.walk.commit();
    }

    /// Lets the walk continue to where it must end, and improves it around some of its gaps.
    pub(super) fn finish(&mut self, concerns: impl Fn(&Walk, u32) -> bool) {
        self.walk.end_at(self.problem.end);
        self.complete = true;
        for gap in 1..=self.walk.len() + 1 {
            if concerns(&self.walk, gap) {
                self.touch(gap);
            }
        }
        self.drain();
        self.walk.commit();
    }

    /// Where the walk ends as it is now.
    fn at(&self) -> Option<Point> {
        match self.walk.len() {
            0 => self.problem.start,
            last => {
                let Visit { item, entry } = self.walk.visit(last);
                Some(self.problem.items[item as usize].ends(entry).1)
            }
        }
    }

    /// Kicks the walk somewhere in a range of positions, repairs it, keeps what is not worse; until `budget` steps are done.
    ///
    /// Iterated local search with segment-local double bridges (Martin, Otto & Felten 1991), local kicks and
    /// undo as in Applegate, Cook & Rohe 2003, doi:10.1287/ijoc.15.1.82.13157.
    ///
    /// Kicks go along the walk from one window of [`WINDOW`] paths to the next, so that what a window needs stays in the
    /// processor's caches.
    pub fn iterate(&mut self, positions: Range<u32>, random: &mut Random, budget: u64) {
        let count = positions.end - positions.start;
        let windows = count.div_ceil(WINDOW);
        self.reach = KICK_REACH;
        for window in 0..windows {
            let bound = |window: u32| {
                positions.start + (u64::from(count) * u64::from(window) / u64::from(windows)) as u32
            };
            let (from, to) = (bound(window), bound(window + 1));
            self.iterate_within(from, to, random, budget * u64::from(to - from) / u64::from(count));
        }
        self.reach = u32::MAX;
    }

    /// Kicks at the positions `from` to `to` − 1, each time at the dearer gap of two, until `budget` steps are done or a part of
    /// them found nothing.
    fn iterate_within(&mut self, from: u32, to: u32, random: &mut Random, budget: u64) {
        let end = self.walk.work + budget;
        let patience = budget / PATIENCE;
        let mut patient_until = self.walk.work + patience;
        while self.walk.work < end.min(patient_until) {
            let [at, other] = [0; 2].map(|_| from + random.below(to - from));
            let dearer = if self.walk.gap(other) > self.walk.gap(at) { other } else { at };
            if self.kick_and_repair(dearer, random) {
                patient_until = self.walk.work + patience;
            }
        }
    }

    /// Kicks the walk at a position, repairs it, and keeps what is not worse; tells whether it is better.
    pub(super) fn kick_and_repair(&mut self, at: u32, random: &mut Random) -> bool {
        self.walk.work += 8;
        self.kick(at, random);
        let group = self.walk.group_at(at);
        let more = if self.is_thorough(group) { random.below(3) } else { 0 };
        for _ in 0..more {
            let stage = self.positions_of_stage(group);
            self.kick(stage.start + random.below(stage.end - stage.start), random);
        }
        self.repair();
        let better = !self.walk.is_worse() && !self.walk.is_as_before();
        if self.walk.is_worse() {
            self.walk.undo();
        } else {
            self.walk.commit();
        }
        better
    }

    /// Whether a group's stage is searched thoroughly.
    fn is_thorough(&self, group: u32) -> bool {
        self.positions_of_stage(group).len() <= self.few
    }

    /// Queues the nodes on both sides of a gap.
    pub(super) fn touch(&mut self, gap: u32) {
        for right in [false, true] {
            let node = self.walk.node(End { gap, right });
            if let Some(queued) = self.queued.get_mut(node as usize)
                && !std::mem::replace(queued, true)
            {
                self.queue.push_back(node);
            }
        }
    }

    fn drain(&mut self) {
        while let Some(node) = self.queue.pop_front() {
            self.queued[node as usize] = false;
            while self.improve(node) {}
        }
    }

    /// As [`Self::drain`], but ends as soon as the walk costs what it did before the kick: most likely it is the same again.
    fn repair(&mut self) {
        while let Some(node) = self.queue.pop_front() {
            self.queued[node as usize] = false;
            while self.improve(node) {
                if self.walk.is_as_before() {
                    self.queue.drain(..).for_each(|node| self.queued[node as usize] = false);
                    return;
                }
            }
        }
    }

    /// Makes one improving move that concerns the link at a node, if there is one.
    fn improve(&mut self, node: u32) -> bool {
        if self.walk.work >= self.next_look {
            self.next_look = self.walk.work + LOOK;
            self.watch.look();
        }
        let item = node / 2;
        // A loop whose other node is queued as well has its turn then.
        let turn = !self.queued[node as usize ^ 1];
        if turn && self.reenter(item) {
            return true;
        }
        let end = self.walk.end_of(node);
        let group = self.walk.group_of(node);
        let (first, last) = self.walk.span(group);
        let outer = end.gap == first || end.gap == last;
        if last - first > 1
            && (self.exchange(end, group)
                || (outer && self.exchange(end.across(), group))
                || (turn && self.reinsert(item)))
        {
            return true;
        }
        (turn && self.is_thorough(group) && self.reenter_beside(self.walk.position(item)))
            || (outer
                && ((self.complete && self.shift(end.gap))
                    || self.reverse_group(group)
                    || self.move_group(group)
                    || self.swap_blocks(end, group)))
    }

    /// Swaps two neighbouring stretches, of one group or of whole groups, at or after a position.
    fn kick(&mut self, at: u32, random: &mut Random) {
        let group = self.walk.group_at(at);
        if self.is_thorough(group)
            && let Some(vertices) = self.walk.vertices(self.walk.item_at(at))
            && random.below(2) == 0
        {
            self.walk.enter(self.walk.item_at(at), random.below(vertices.len() as u32));
        }
        if self.walk.span(group).1 <= self.walk.len() && random.below(SHIFT) == 0 {
            self.kick_junction(group, random);
            return;
        }
        let (first, end) = self.walk.span(group);
        if self.groups_in_stage(group) > 1 && (end - first < 3 || random.below(4) == 0) {
            self.kick_groups(group, random);
            return;
        }
        if end - first < 2 {
            return;
        }
        let from = at.min(end - 2);
        let middle = from + 1 + random.below(KICK.min(end - from - 1));
        let to = middle + 1 + random.below(KICK.min(end - middle));
        let reversed = random.below(8);
        self.walk.swap(from, middle, to, reversed == 0, reversed == 1);
        [from, from + (to - middle), to].into_iter().for_each(|gap| self.touch(gap));
    }
}
