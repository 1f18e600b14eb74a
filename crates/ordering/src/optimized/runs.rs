//! Moving whole groups (runs) and units (islands) between positions.

use super::super::index::{Entry, Index};
use super::super::precedence::GroupPosition;
use super::end::{End, GAIN, NONE};
use super::gaps::Gaps;
use super::state::Search;
use pathwright_geometry::Random;

/// Most groups in one block that moves.
const BLOCK: u32 = 4;
/// With at most this many groups in a stage, all gaps between groups are tried; with more, those beside near groups.
const FEW: u32 = 12;
/// Near groups of each group.
const NEAR: usize = 24;
/// Positions of a group from which near groups are looked for, and how many from each.
const SAMPLES: usize = 4;
const NEAR_SAMPLE: usize = 6;

impl Search<'_> {
    /// Moves a block of consecutive groups that begins or ends with this one, where precedence lets it, to the gap
    /// between groups where it costs least: forwards, or reversed if it is one group, or entered at its best vertex if
    /// it is one loop.
    pub fn move_group(&mut self, group: u32) -> bool {
        if self.groups_in_stage(group) < 2 {
            return false;
        }
        let (first, end) = self.walk.span(group);
        if self.groups.whole_units {
            let (first, end) = self.unit_span(first, end);
            return self.move_block(first, end);
        }
        if self.move_block(first, end) {
            return true;
        }
        let (mut from, mut to) = (first, end);
        for _ in 1..BLOCK {
            (from, to) = (self.start_of_last(from), self.end_of_next(to));
            if self.move_block(first, to) || self.move_block(from, end) {
                return true;
            }
        }
        false
    }

    /// Number of groups in the stage of a group.
    pub fn groups_in_stage(&self, group: u32) -> u32 {
        let (first, end) = self.vicinity.stage[group as usize].groups;
        end - first
    }

    /// Positions of the stage of a group.
    pub fn positions_of_stage(&self, group: u32) -> std::ops::Range<u32> {
        let (first, end) = self.vicinity.stage[group as usize].gaps;
        first..end
    }

    /// Draws a group in reverse if that is cheaper.
    pub fn reverse_group(&mut self, group: u32) -> bool {
        let (from, to) = self.walk.span(group);
        let node = |gap, right| self.walk.node(End { gap, right });
        let (before, enter, leave, after) =
            (node(from, false), node(from, true), node(to, false), node(to, true));
        let now = self.walk.gap(from) + self.walk.gap(to);
        let reversed = self.walk.link(before, leave) + self.walk.link(enter, after);
        self.walk.work += 4;
        let dearer = |reversed: f64| reversed >= now - GAIN;
        if dearer(reversed)
            || dearer(reversed + self.walk.surcharge(before, leave) + self.walk.surcharge(enter, after))
        {
            return false;
        }
        self.walk.reverse(from, to - 1);
        self.touch(from);
        self.touch(to);
        true
    }

    /// Where the group after a gap ends; the gap itself at the end of the walk.
    fn end_of_next(&self, gap: u32) -> u32 {
        if gap > self.walk.len() { gap } else { self.walk.span(self.walk.group_at(gap)).1 }
    }

    /// Where the group before a gap starts; the gap itself at the start of the walk.
    fn start_of_last(&self, gap: u32) -> u32 {
        if gap <= 1 { gap } else { self.walk.span(self.walk.group_at(gap - 1)).0 }
    }

    fn unit_at(&self, position: u32) -> Option<GroupPosition> {
        self.groups.positions.get(self.walk.group_at(position) as usize).copied()
    }

    /// Widens a stretch of whole groups until it holds whole units.
    fn unit_span(&self, mut from: u32, mut to: u32) -> (u32, u32) {
        while from > 1 && self.unit_at(from - 1) == self.unit_at(from) {
            from = self.start_of_last(from);
        }
        while to <= self.walk.len() && self.unit_at(to) == self.unit_at(to - 1) {
            to = self.end_of_next(to);
        }
        (from, to)
    }

    /// The gaps from and to which a block of groups may move: it stays in its stage and passes no group that its unit
    /// has before or after.
    fn window(&self, from: u32, to: u32) -> (u32, u32) {
        let (mut low, mut high) = self.vicinity.stage[self.walk.group_at(from) as usize].gaps;
        if to > high || from < low {
            return (from, to);
        }
        let mut at = from;
        while at < to {
            let group = self.walk.group_at(at);
            at = self.end_of_next(at);
            if let Some(next) = self.groups.next_in_unit(group) {
                let (begins, _) = self.walk.span(next);
                high = if begins >= to { high.min(begins) } else { high };
            }
            if let Some(before) = self.groups.previous_in_unit(group) {
                let (_, ends) = self.walk.span(before);
                low = if ends <= from { low.max(ends) } else { low };
            }
        }
        (low, high)
    }

    fn move_block(&mut self, from: u32, to: u32) -> bool {
        let node = |walk: &super::walk::Walk, gap, right| walk.node(End { gap, right });
        let (before, after) = (node(&self.walk, from, false), node(&self.walk, to, true));
        let (enter, leave) = (node(&self.walk, from, true), node(&self.walk, to, false));
        let mut saved = self.walk.gap(from) + self.walk.gap(to) - self.walk.link(before, after);
        self.walk.work += 3;
        if saved > GAIN {
            saved -= self.walk.surcharge(before, after);
        }
        if saved <= GAIN {
            return false;
        }
        let (low, high) = self.window(from, to);
        if low == from && high == to {
            return false;
        }
        let group = self.walk.group_at(from);
        let lone = self.walk.group_at(to - 1) == group;
        let disc = if lone { self.vicinity.disc[group as usize] } else { None };
        let mut best = (saved - GAIN, NONE, false);
        let mut gaps = std::mem::take(&mut self.gaps);
        self.gaps_near(from, to, low, high, &mut gaps);
        for at in 0..gaps.found.len() {
            let gap = gaps.found[at];
            self.walk.work += 4;
            if disc.is_none() && gaps.is_tried(gap) {
                continue;
            }
            let (left, right) = (node(&self.walk, gap, false), node(&self.walk, gap, true));
            let link = self.walk.gap(gap);
            if let Some((center, radius)) = disc {
                let least = |node| self.walk.beyond(self.walk.point(node), center, radius);
                if least(left) + least(right) - link < best.0 {
                    let item = self.walk.item_at(from);
                    let (cost, _) = self.best_vertex(item, left, right, best.0 + link);
                    if cost - link < best.0 {
                        best = (cost - link, gap, false);
                    }
                }
                continue;
            }
            for (reversed, first, last) in [(false, enter, leave), (true, leave, enter)] {
                if reversed && !lone {
                    break;
                }
                // One of its links is often too long already.
                let one = self.walk.link(left, first);
                if one - link >= best.0 {
                    continue;
                }
                let mut cost = one + self.walk.link(last, right) - link;
                if cost < best.0 {
                    cost += self.walk.surcharge(left, first) + self.walk.surcharge(last, right);
                }
                if cost < best.0 {
                    best = (cost, gap, reversed);
                }
            }
        }
        self.gaps = gaps;
        let (_, gap, reversed) = best;
        if gap == NONE {
            return false;
        }
        if disc.is_some() {
            let item = self.walk.item_at(from);
            let (left, right) = (node(&self.walk, gap, false), node(&self.walk, gap, true));
            let (_, entry) = self.best_vertex(item, left, right, 0.0);
            self.walk.enter(item, entry);
        }
        let gaps = if gap < from {
            self.walk.swap(gap, from, to, false, reversed);
            [gap, gap + (to - from), to]
        } else {
            self.walk.swap(from, to, gap, reversed, false);
            [from, from + (gap - to), gap]
        };
        gaps.into_iter().for_each(|gap| self.touch(gap));
        true
    }

    /// Finds the gaps between groups (units, where these stay whole) worth trying for a block, within its window; some come
    /// several times.
    fn gaps_near(&mut self, from: u32, to: u32, low: u32, high: u32, gaps: &mut Gaps) {
        gaps.clear(self.walk.len() + 2);
        let reach = self.reach;
        let is_near = |gap: u32| {
            (low..=high).contains(&gap) && !(from..=to).contains(&gap) && gap.abs_diff(from) <= reach
        };
        let mut add = |search: &Self, gap: u32| {
            if is_near(gap) && search.parts_units(gap) {
                gaps.found.push(gap);
            }
        };
        let (first, last) = (self.walk.group_at(from), self.walk.group_at(to - 1));
        if self.groups_in_stage(first) <= FEW {
            let mut gap = low;
            while gap < high {
                add(self, gap);
                gap = self.end_of_next(gap);
            }
            add(self, high);
            return;
        }
        for group in std::iter::once(first).chain((first != last).then_some(last)) {
            self.find_near_groups(group);
            for &near in self.vicinity.near[group as usize].iter().flatten() {
                let (first, end) = self.walk.span(near);
                add(self, first);
                add(self, end);
            }
        }
        add(self, low);
        add(self, high);
    }

    /// Whether no unit that must stay whole lies on both sides of a gap.
    pub fn parts_units(&self, gap: u32) -> bool {
        !self.groups.whole_units
            || gap <= 1
            || gap > self.walk.len()
            || self.unit_at(gap - 1) != self.unit_at(gap)
    }

    /// Gaps before groups of the stage of one that lie near it, and the gap after the stage.
    pub fn begins_near(&mut self, group: u32) -> Vec<u32> {
        let stage = self.vicinity.stage[group as usize];
        let mut gaps = Vec::with_capacity(NEAR + 1);
        if self.groups_in_stage(group) <= FEW {
            gaps.extend((stage.groups.0..stage.groups.1).map(|group| self.walk.span(group).0));
        } else {
            self.find_near_groups(group);
            let near = self.vicinity.near[group as usize].iter().flatten();
            gaps.extend(near.map(|&group| self.walk.span(group).0));
        }
        gaps.push(stage.gaps.1);
        gaps
    }

    /// Finds the groups of its stage nearest to a group, on first use.
    fn find_near_groups(&mut self, group: u32) {
        if self.vicinity.near[group as usize].is_some() {
            return;
        }
        let (problem, groups) = (self.problem, self.groups);
        let index = self.vicinity.index.get_or_insert_with(|| Index::new(problem, groups));
        let stage = self.vicinity.stage[group as usize].groups;
        if self.vicinity.open != stage {
            let (first, end) = std::mem::replace(&mut self.vicinity.open, stage);
            (first..end).for_each(|group| index.close(group));
            (stage.0..stage.1).for_each(|group| index.open(group));
        }
        index.close(group);
        let items = &groups.items[group as usize];
        let (mut near, mut found): (Vec<Entry>, Vec<Entry>) = (Vec::new(), Vec::new());
        for &item in items.iter().step_by(items.len().div_ceil(SAMPLES)) {
            let entries = self.walk.vertices(item).map_or(2, <[_]>::len);
            for entry in [0, entries / 2] {
                let point = problem.items[item as usize].ends(entry as u32).0;
                index.nearest_groups(point, groups, NEAR_SAMPLE, &mut found);
                near.extend_from_slice(&found);
            }
        }
        index.open(group);
        near.sort_unstable();
        let mut nearest: Vec<u32> = Vec::with_capacity(NEAR);
        for entry in near {
            if nearest.len() < NEAR && !nearest.contains(&entry.item) {
                nearest.push(entry.item);
            }
        }
        self.vicinity.near[group as usize] = Some(nearest);
    }

    /// Swaps two neighbouring blocks of groups, if precedence lets them pass each other.
    pub fn kick_groups(&mut self, group: u32, random: &mut Random) {
        let (mut from, mut middle) = self.walk.span(group);
        for _ in 0..random.below(BLOCK) {
            middle = self.end_of_next(middle);
        }
        if self.groups.whole_units {
            (from, middle) = self.unit_span(from, middle);
        }
        let mut to = middle;
        for _ in 0..=random.below(BLOCK) {
            to = self.end_of_next(to);
        }
        if self.groups.whole_units && to > middle {
            (_, to) = self.unit_span(middle, to);
        }
        if to == middle || self.window(from, middle).1 < to {
            return;
        }
        // A block of several groups cannot be reversed: their order is not free.
        let lone = |from: u32, to: u32| self.walk.group_at(from) == self.walk.group_at(to - 1);
        let reversed = random.below(4);
        let (first, second) = (reversed == 0 && lone(from, middle), reversed == 1 && lone(middle, to));
        self.walk.swap(from, middle, to, first, second);
        [from, from + (to - middle), to].into_iter().for_each(|gap| self.touch(gap));
    }
}
