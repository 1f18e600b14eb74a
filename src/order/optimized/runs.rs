//! Moving whole groups (runs) and units (islands) between positions.

use super::random::Random;
use super::search::{GAIN, Search};
use super::walk::{End, NONE};

/// Groups of one block that moves.
const BLOCK: u32 = 4;
/// With at most so many groups, all gaps between groups are tried; with more, those beside near groups.
const FEW: usize = 12;
/// Places of a group from which near groups are looked for.
const SAMPLES: usize = 8;
/// Near groups per sample.
const NEAR_SAMPLE: usize = 4;

impl Search<'_> {
    /// Moves a block of consecutive groups that begins or ends with this one, where precedence lets it, to the gap
    /// between groups where it costs least: forwards, or reversed if it is one group, or entered at its best vertex if
    /// it is one loop.
    pub fn move_group(&mut self, group: u32) -> bool {
        if self.groups.items.len() < 2 {
            return false;
        }
        let (first, end) = self.walk.span(group);
        if self.groups.whole_units {
            let (first, end) = self.unit_span(first, end);
            return self.move_block(first, end);
        }
        let (mut from, mut to) = (first, end);
        for _ in 0..BLOCK {
            if self.move_block(first, to) || (from < first && self.move_block(from, end)) {
                return true;
            }
            to = self.end_of_next(to);
            from = self.start_of_last(from);
        }
        false
    }

    /// Where the group after a gap ends; the gap itself at the end of the walk.
    fn end_of_next(&self, gap: u32) -> u32 {
        if gap > self.walk.len() { gap } else { self.walk.span(self.walk.group_at(gap)).1 }
    }

    /// Where the group before a gap starts; the gap itself at the start of the walk.
    fn start_of_last(&self, gap: u32) -> u32 {
        if gap <= 1 { gap } else { self.walk.span(self.walk.group_at(gap - 1)).0 }
    }

    fn unit_at(&self, position: u32) -> Option<super::super::precedence::Place> {
        self.groups.place.get(self.walk.group_at(position) as usize).copied()
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

    /// The gaps from and to which a block of groups may move: it passes no other stage and no group of its units.
    fn window(&self, from: u32, to: u32) -> (u32, u32) {
        let mut units = Vec::with_capacity(BLOCK as usize);
        let mut at = from;
        while at < to {
            units.push(self.unit_at(at));
            at = self.end_of_next(at);
        }
        let stage = units[0].map(|unit| unit.stage);
        let stops = |place: Option<super::super::precedence::Place>| {
            place.map(|place| place.stage) != stage || units.contains(&place)
        };
        if units.iter().any(|unit| unit.map(|unit| unit.stage) != stage) {
            return (from, to);
        }
        let (mut low, mut high) = (from, to);
        while low > 1 && from - low < self.reach && !stops(self.unit_at(low - 1)) {
            low = self.start_of_last(low);
        }
        while high <= self.walk.len() && high - to < self.reach && !stops(self.unit_at(high)) {
            high = self.end_of_next(high);
        }
        (low, high)
    }

    fn move_block(&mut self, from: u32, to: u32) -> bool {
        let before = self.walk.node(End { gap: from, right: false });
        let after = self.walk.node(End { gap: to, right: true });
        let (enter, leave) =
            (self.walk.node(End { gap: from, right: true }), self.walk.node(End { gap: to, right: false }));
        let saved = self.walk.gap(from) + self.walk.gap(to) - self.walk.link(before, after);
        if saved <= GAIN {
            return false;
        }
        let (low, high) = self.window(from, to);
        if low == from && high == to {
            return false;
        }
        let group = self.walk.group_at(from);
        let lone = self.walk.group_at(to - 1) == group;
        let looped = to - from == 1 && self.walk.is_loop(self.walk.item_at(from));
        let mut best = (saved - GAIN, NONE, false);
        for gap in self.gaps_near(from, to, low, high) {
            let left = self.walk.node(End { gap, right: false });
            let right = self.walk.node(End { gap, right: true });
            let link = self.walk.link(left, right);
            self.walk.work += 4;
            if looped {
                let item = self.walk.item_at(from);
                let (cost, _) = self.best_vertex(item, self.walk.place(left), self.walk.place(right));
                if cost - link < best.0 {
                    best = (cost - link, gap, false);
                }
                continue;
            }
            let forwards = self.walk.link(left, enter) + self.walk.link(leave, right) - link;
            if forwards < best.0 {
                best = (forwards, gap, false);
            }
            let backwards = self.walk.link(left, leave) + self.walk.link(enter, right) - link;
            if lone && backwards < best.0 {
                best = (backwards, gap, true);
            }
        }
        let (_, gap, reversed) = best;
        if gap == NONE {
            return false;
        }
        if looped {
            let item = self.walk.item_at(from);
            let left = self.walk.place(self.walk.node(End { gap, right: false }));
            let right = self.walk.place(self.walk.node(End { gap, right: true }));
            let (_, entry) = self.best_vertex(item, left, right);
            self.walk.enter(item, entry);
        }
        let middle = if gap < from {
            self.walk.swap(gap, from, to, false, reversed);
            [gap, gap + (to - from), to]
        } else {
            self.walk.swap(from, to, gap, reversed, false);
            [from, from + (gap - to), gap]
        };
        middle.into_iter().for_each(|gap| self.touch(gap));
        true
    }

    /// Gaps between groups (units, where these stay whole) worth trying for a block, within its window.
    fn gaps_near(&mut self, from: u32, to: u32, low: u32, high: u32) -> Vec<u32> {
        let mut gaps = Vec::new();
        if self.groups.items.len() <= FEW {
            let mut gap = low;
            while gap < high {
                gaps.push(gap);
                gap = self.end_of_next(gap);
            }
            gaps.push(high);
        } else {
            for at in [from, to - 1] {
                let group = self.walk.group_at(at);
                self.find_near_groups(group);
                let spans = self.near_groups[group as usize].iter().map(|&near| self.walk.span(near));
                gaps.extend(spans.flat_map(|(first, end)| [first, end]));
            }
            gaps.extend([low, high]);
            gaps.sort_unstable();
            gaps.dedup();
        }
        let inside_unit = |gap: u32| {
            self.groups.whole_units
                && gap > 1
                && gap <= self.walk.len()
                && self.unit_at(gap - 1) == self.unit_at(gap)
        };
        gaps.retain(|&gap| (low..=high).contains(&gap) && !(from..=to).contains(&gap) && !inside_unit(gap));
        gaps
    }

    /// Finds the groups that lie nearest to a group, when first asked for.
    fn find_near_groups(&mut self, group: u32) {
        if self.near_groups.is_empty() {
            self.near_groups = vec![Vec::new(); self.groups.items.len()];
        }
        if self.near_groups[group as usize].is_empty() {
            let items = &self.groups.items[group as usize];
            let (mut near, mut found) = (Vec::new(), Vec::new());
            self.index.close(group);
            for &item in items.iter().step_by(items.len().div_ceil(SAMPLES)) {
                let entries = self.walk.vertices(item).map_or(2, <[_]>::len);
                for entry in [0, entries / 2] {
                    let point = self.problem.items[item as usize].ends(entry as u32).0;
                    self.index.nearest_groups(point, self.groups, NEAR_SAMPLE, &mut found);
                    near.extend(found.iter().map(|entry| entry.item));
                }
            }
            self.index.open(group);
            near.sort_unstable();
            near.dedup();
            self.near_groups[group as usize] = near;
        }
    }

    /// Swaps two neighbouring blocks of groups, if precedence lets them pass each other.
    pub fn kick_groups(&mut self, group: u32, random: &mut Random) -> bool {
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
            return false;
        }
        self.walk.swap(from, middle, to, false, false);
        [from, from + (to - middle), to].into_iter().for_each(|gap| self.touch(gap));
        true
    }
}
