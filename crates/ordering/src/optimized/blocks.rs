//! Swapping neighbouring stretches of whole groups (runs), however long.

use super::end::End;
use super::end::GAIN;
use super::state::Search;

/// Groups that a stretch may grow by while its partner stays.
const FAR: u32 = 64;

/// Three ascending gaps between groups of one stage: the stretches between them change places.
type Gaps = [u32; 3];

impl Search<'_> {
    /// Makes the best improving swap of two neighbouring stretches of groups that removes the link at a node: the
    /// 3-opt move that reverses nothing, as precedence requires.
    ///
    /// One new link leads on from the node before the gap to a near group. Whether the stretches may be swapped is checked group by
    /// group as one of them grows, each in constant time (Gambardella & Dorigo 2000, doi:10.1287/ijoc.12.3.237.12636).
    pub fn swap_blocks(&mut self, End { gap, right }: End, group: u32) -> bool {
        let removed = self.walk.gap(gap);
        let stage = self.positions_of_stage(group);
        if (right && gap != stage.start)
            || removed <= GAIN
            || self.groups_in_stage(group) < 3
            || !self.parts_units(gap)
        {
            return false;
        }
        let left = self.walk.node(End { gap, right: false });
        let mut best = (GAIN, None);
        for other in self.begins_near(group) {
            if other == gap || other.abs_diff(gap) > self.reach || !self.parts_units(other) {
                continue;
            }
            let added = self.walk.link(left, self.walk.node(End { gap: other, right: true }));
            self.walk.work += 2;
            if added >= removed - GAIN {
                continue;
            }
            if other < gap {
                self.between(other, gap, &mut best);
            } else {
                self.after(gap, other, stage.end, &mut best);
                self.before(gap, other, stage.start, &mut best);
            }
        }
        let Some([from, middle, to]) = best.1 else { return false };
        self.walk.swap(from, middle, to, false, false);
        [from, from + (to - middle), to].into_iter().for_each(|gap| self.touch(gap));
        true
    }

    /// Tries to swap `[x, y)` with what follows, up to a gap.
    fn after(&mut self, x: u32, y: u32, last: u32, best: &mut (f64, Option<Gaps>)) {
        let mut z = y;
        for _ in 0..FAR {
            if z >= last {
                return;
            }
            let group = self.walk.group_at(z);
            let needs = self.groups.previous_in_unit(group);
            if needs.is_some_and(|needs| (x..y).contains(&self.walk.span(needs).0)) {
                return;
            }
            z = self.walk.span(group).1;
            self.weigh([x, y, z], best);
        }
    }

    /// Tries to swap `[y, z)` with what comes before, down to a gap.
    fn before(&mut self, y: u32, z: u32, first: u32, best: &mut (f64, Option<Gaps>)) {
        let mut x = y;
        for _ in 0..FAR {
            if x <= first {
                return;
            }
            let group = self.walk.group_at(x - 1);
            let next = self.groups.next_in_unit(group);
            if next.is_some_and(|next| (y..z).contains(&self.walk.span(next).0)) {
                return;
            }
            x = self.walk.span(group).0;
            self.weigh([x, y, z], best);
        }
    }

    /// Tries to swap the parts of `[x, z)`.
    fn between(&mut self, x: u32, z: u32, best: &mut (f64, Option<Gaps>)) {
        let mut y = x;
        // Up to here groups must come after some of those before `y`.
        let mut tied = x;
        for _ in 0..FAR {
            let group = self.walk.group_at(y);
            if let Some(next) = self.groups.next_in_unit(group) {
                let (begin, end) = self.walk.span(next);
                tied = if begin < z { tied.max(end) } else { tied };
            }
            y = self.walk.span(group).1;
            if y >= z {
                return;
            }
            if tied <= y {
                self.weigh([x, y, z], best);
            }
        }
    }

    /// Keeps a swap if it saves more than the best.
    fn weigh(&mut self, gaps: Gaps, best: &mut (f64, Option<Gaps>)) {
        let [x, y, z] = gaps;
        let added = [(x, y), (z, x), (y, z)].map(|(before, after)| {
            [End { gap: before, right: false }, End { gap: after, right: true }]
                .map(|end| self.walk.node(end))
        });
        let mut gain = gaps.iter().map(|&gap| self.walk.gap(gap)).sum::<f64>();
        gain -= added.iter().map(|&[a, b]| self.walk.link(a, b)).sum::<f64>();
        self.walk.work += 6;
        if gain > best.0 {
            gain -= added.iter().map(|&[a, b]| self.walk.surcharge(a, b)).sum::<f64>();
        }
        if gain > best.0 && gaps.iter().all(|&gap| self.parts_units(gap)) {
            *best = (gain, Some(gaps));
        }
    }
}
