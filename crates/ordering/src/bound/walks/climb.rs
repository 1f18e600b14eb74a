//! The ascent of relaxed walks.

use pathwright_geometry::real;

use crate::options::Effort;

use super::{Cheapest, FAR, MOST, Set, States, Walk, Walks};

/// How much is spent on a layer.
#[derive(Clone, Copy, Debug)]
pub struct Budget {
    /// Rounds, each of which looks at all walks, and steps in each.
    pub rounds: usize,
    pub steps: usize,
    /// How many other blocks walks remember at each at first: the first of these of which the turns are not too many.
    pub memories: &'static [usize],
    /// Most turns of blocks, vertices, and pairs of states.
    pub turns: usize,
    pub vertices: usize,
    pub pairs: usize,
    /// Work for each path: additions, about.
    pub work: u64,
}

impl Budget {
    /// For walks of which none is left out.
    pub(in super::super) fn new(effort: Effort) -> Self {
        let (rounds, steps, memories) = (8, 15, &[MOST, 8, 5, 3, 1]);
        match effort {
            Effort::Fast | Effort::Normal => {
                Self { rounds, steps, memories, turns: 1_000, vertices: 2_000, pairs: 100_000, work: 400_000 }
            }
            Effort::High => Self {
                rounds: 16,
                steps: 20,
                memories,
                turns: 8_000,
                vertices: 6_000,
                pairs: 1_000_000,
                work: 10_000_000,
            },
        }
    }

    /// For walks that are left out from a limit on: they may begin with little memory, since it grows.
    pub(in super::super) fn limited(effort: Effort) -> Self {
        let new = Self::new(effort);
        let limited = Self { rounds: 200, steps: 20, memories: &[2, 1], turns: 10_000, ..new };
        if effort == Effort::High { limited } else { Self { pairs: 200_000, work: 5 * new.work, ..limited } }
    }
}

/// The first step, as a share of the first multipliers' mean, and the last as a share of that.
const FIRST: f64 = 0.3;
const LAST: f64 = 0.02;
/// The first step of a later ascent, for other ends.
const AGAIN: f64 = 0.05;
/// How far a step follows its own direction; the rest follows the one before it.
const FRESH: f64 = 0.7;
/// Within a round only walks count that cost little more than the cheapest: at first by so many times the mean multiplier and path;
const SLACK: f64 = 0.15;
/// less in each round that does better than all before, more if there was too little for the multipliers to hold on to.
const NARROWER: f64 = 0.7;
const WIDER: f64 = 2.0;
/// The step to where the cheapest walk would cost as much as the limit, if all went on as it begins, times this (Polyak 1969,
/// <https://doi.org/10.1016/0041-5553(69)90061-5>).
const POLYAK: f64 = 0.5;
/// Pairs of states up to which memories may grow in a round; or to twice as many as there are.
const GROWTH: usize = 100_000;
/// Rounds in which the bound must come nearer to the limit by this share of what is left.
const STALE: usize = 5;
const SLOW: f64 = 0.05;
/// Looks at all walks in a round.
const LOOKS: u64 = 3;
/// Walks that draw a path again after more others do not make these remember it.
const LONG: usize = 8;

/// What the walks of a round did wrong.
#[derive(Default)]
struct Faults {
    /// Loops left elsewhere than they were entered, with the vertices.
    crossed: Vec<(u32, usize)>,
    /// Paths drawn twice, with those in between.
    repeated: Vec<(u32, Vec<u32>)>,
    /// Blocks drawn twice or too late, with those that must remember them.
    returned: Vec<(u32, Vec<u32>)>,
}

impl Walks<'_> {
    /// Seeks better multipliers, and divides loops and remembers paths where the cheapest walks cheat. Walks that cost `limit` or
    /// more may be left out for good; the bound is not above it.
    pub(in super::super) fn climb(&mut self, limit: Option<i64>) {
        self.limit = limit;
        let count = self.model.bodies.len();
        let mut slack = SLACK * self.step * count as f64;
        let mut step = self.step * if self.climbed { AGAIN } else { FIRST };
        self.climbed = true;
        let mut now = self.multipliers.clone();
        let mut proved = i64::MIN;
        let mut work = self.budget.work * count as u64;
        // The bound some rounds ago, and in which.
        let mut before = (0, i64::MIN);
        for round in 0..self.budget.rounds {
            let mut cheapest = self.cheapest(&self.states, &now);
            if cheapest.bound >= proved {
                slack *= if round == 0 { 1.0 } else { NARROWER };
                self.multipliers.clone_from(&now);
            } else {
                slack *= WIDER;
                now.clone_from(&self.multipliers);
                cheapest = self.cheapest(&self.states, &now);
            }
            proved = proved.max(cheapest.bound);
            if let Some(limit) = limit
                && proved >= limit
            {
                proved = limit;
                self.closed = true;
                break;
            }
            if let Some(limit) = limit
                && round >= before.0 + STALE
            {
                // From nothing as yet to something is never slow.
                if proved.saturating_sub(before.1) as f64 <= SLOW * (limit - proved) as f64 {
                    break;
                }
                before = (round, proved);
            }
            let walk = self.walk(&self.states, &cheapest);
            let wrong = self.crossed(&walk);
            self.closed = wrong.is_empty() && self.drawn(&walk).iter().all(|&times| times == 1);
            if self.closed {
                self.best = Some((cheapest.bound, walk));
                break;
            }
            if round + 1 == self.budget.rounds {
                break;
            }
            let on = self.states.costs_on(&self.poses, &cheapest);
            let left = limit.map_or(FAR, |limit| (limit - 1 - cheapest.bound) as f64);
            let few = self.states.trimmed(&self.poses, &cheapest, &on, real::lesser(left, slack.floor()));
            let spent = LOOKS * self.work(&self.states) + self.budget.steps as u64 * self.work(&few);
            if spent > work {
                break;
            }
            work -= spent;
            if limit.is_some() {
                self.states = self.states.trimmed(&self.poses, &cheapest, &on, left);
            }
            let mut faults = Faults { crossed: wrong, ..Faults::default() };
            now = self.climb_few(&few, &now, &mut step, limit, &mut faults);
            self.mend(&faults);
        }
        self.bound = proved;
    }

    /// The best multipliers for the walks of a part of the graph, from those given.
    fn climb_few(
        &mut self,
        few: &States,
        from: &[i64],
        step: &mut f64,
        limit: Option<i64>,
        faults: &mut Faults,
    ) -> Vec<i64> {
        let mut at: Vec<f64> = from.iter().map(|&multiplier| multiplier as f64).collect();
        let mut last = vec![0.0; at.len()];
        let mut best = (i64::MIN, from.to_vec());
        let steps = self.budget.steps;
        let shrink = real::pow(LAST, 1.0 / (steps * self.budget.rounds) as f64);
        let mut splits = 0;
        let mut k = 0;
        while k < steps {
            let now: Vec<i64> = at.iter().map(|&multiplier| multiplier as i64).collect();
            let cheapest = self.cheapest(few, &now);
            let walk = self.walk(few, &cheapest);
            if cheapest.bound > best.0 {
                best = (cheapest.bound, now);
            }
            let drawn = self.drawn(&walk);
            let crossed = self.crossed(&walk);
            if drawn.iter().all(|&times| times == 1) {
                splits += 1;
                best.1 = at.iter().map(|&multiplier| multiplier as i64).collect();
                if crossed.is_empty() || splits > steps || !self.poses.split(self.model, &crossed) {
                    return best.1;
                }
                best.0 = i64::MIN;
                continue;
            }
            if 4 * k >= 3 * steps {
                faults.crossed.extend(crossed);
            }
            if limit.is_none() || 4 * k >= 3 * steps {
                self.repeated(&walk, faults);
            }
            if let Some(limit) = limit {
                let square: i32 = drawn.iter().map(|&times| (1 - times) * (1 - times)).sum();
                *step = POLYAK * (limit - cheapest.bound).max(0) as f64 / f64::from(square);
            }
            for (i, &times) in drawn.iter().enumerate() {
                let direction = f64::from(1 - times);
                at[i] += *step * (FRESH * direction + (1.0 - FRESH) * last[i]);
                last[i] = direction;
            }
            *step *= shrink;
            k += 1;
        }
        best.1
    }

    fn walk(&self, states: &States, cheapest: &Cheapest) -> Walk {
        states.walk(&self.poses, cheapest)
    }

    /// How often a walk draws each path.
    fn drawn(&self, walk: &Walk) -> Vec<i32> {
        let mut drawn = vec![0; self.model.bodies.len()];
        walk.iter().for_each(|&pose| drawn[self.poses.item_of(pose) as usize] += 1);
        drawn
    }

    /// Paths that a walk draws again in one block, blocks that it draws again or too late, and those in between.
    fn repeated(&self, walk: &Walk, faults: &mut Faults) {
        let items: Vec<u32> = walk.iter().map(|&pose| self.poses.item_of(pose)).collect();
        let mut blocks: Vec<u32> = Vec::new();
        let mut left = 0;
        for (k, &item) in items.iter().enumerate() {
            let block = self.blocks.of[item as usize];
            if left == 0 {
                left = self.blocks.items[block as usize].len();
                let before = &blocks[blocks.len().saturating_sub(LONG)..];
                let bars =
                    |other: u32| other == block || self.blocks.before[other as usize] >> block & 1 == 1;
                if let Some(back) = before.iter().rposition(|&other| bars(other)) {
                    let back = back + usize::from(before[back] == block);
                    faults.returned.push((block, before[back..].to_vec()));
                }
                blocks.push(block);
            }
            left -= 1;
            let before = &items[k.saturating_sub(LONG)..k];
            let Some(back) = before.iter().rposition(|&other| other == item) else { continue };
            let between = &before[back + 1..];
            if between.iter().all(|&other| self.blocks.of[other as usize] == block) {
                faults.repeated.push((item, between.to_vec()));
            }
        }
    }

    /// Divides loops, and remembers paths, where walks cheated.
    fn mend(&mut self, faults: &Faults) {
        self.poses.split(self.model, &faults.crossed);
        let (mut remembered, blocks) = (self.remembered.clone(), self.blocks.remembered.clone());
        for (item, between) in &faults.repeated {
            let nth = self.blocks.nth[*item as usize];
            between.iter().for_each(|&other| remembered[other as usize] |= (1 as Set) << nth);
        }
        for (block, between) in &faults.returned {
            between.iter().for_each(|&other| self.blocks.remembered[other as usize] |= (1 as Set) << block);
        }
        if remembered == self.remembered && blocks == self.blocks.remembered {
            return;
        }
        let most = self.budget.pairs.min(GROWTH.max(2 * self.states.pairs()));
        match self.states.refined(&self.blocks, &remembered, most) {
            Some(states) => (self.states, self.remembered) = (states, remembered),
            None => self.blocks.remembered = blocks,
        }
    }

    /// What it takes to look at all walks of a graph, about.
    pub(super) fn work(&self, states: &States) -> u64 {
        let poses = (self.poses.count() / self.model.bodies.len().max(1)) as u64;
        states.pairs() as u64 * (8 + poses)
    }
}
