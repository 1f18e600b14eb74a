//! The ascent of relaxed walks.

use crate::options::Effort;

use super::{Cheapest, Set, States, Walk, Walks};

/// How much is spent on a layer.
#[derive(Clone, Copy, Debug)]
pub struct Budget {
    /// Rounds, each of which looks at all walks, and steps in each.
    pub rounds: usize,
    pub steps: usize,
    /// Most turns of blocks, vertices, and pairs of states.
    pub turns: usize,
    pub vertices: usize,
    pub pairs: usize,
    /// Work for each path: additions, about.
    pub work: u64,
}

impl Budget {
    /// For a proof that an order is an optimum.
    pub(in super::super) fn proof(effort: Effort) -> Self {
        Self::new(effort)
    }

    pub(in super::super) fn new(effort: Effort) -> Self {
        match effort {
            Effort::Fast | Effort::Normal => {
                Self { rounds: 8, steps: 15, turns: 1_000, vertices: 2_000, pairs: 100_000, work: 400_000 }
            }
            Effort::High => Self {
                rounds: 16,
                steps: 20,
                turns: 8_000,
                vertices: 6_000,
                pairs: 1_000_000,
                work: 10_000_000,
            },
        }
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
        let count = self.model.bodies.len();
        let mut slack = SLACK * self.step * count as f64;
        let mut step = self.step * if self.climbed { AGAIN } else { FIRST };
        self.climbed = true;
        let mut now = self.multipliers.clone();
        let mut proved = i64::MIN;
        let mut work = self.budget.work * count as u64;
        let mut worse = 0;
        let rounds = if limit.is_some() { 200 } else { self.budget.rounds };
        for round in 0..rounds {
            let mut cheapest = self.cheapest(&self.states, &now);
            if cheapest.bound >= proved {
                slack *= if round == 0 { 1.0 } else { NARROWER };
                self.multipliers.clone_from(&now);
            } else {
                slack *= WIDER;
                worse += 1;
                now.clone_from(&self.multipliers);
                cheapest = self.cheapest(&self.states, &now);
            }
            proved = proved.max(cheapest.bound);
            if std::env::var("PW_TRACE").is_ok() {
                eprintln!(
                    "round {round} bound {} limit {:?} pairs {} poses {} work {work} worse {worse}",
                    cheapest.bound,
                    limit,
                    self.states.pairs(),
                    self.poses.count()
                );
            }
            if let Some(limit) = limit
                && proved >= limit
            {
                proved = limit;
                self.closed = true;
                break;
            }
            let walk = self.walk(&self.states, &cheapest);
            let wrong = self.crossed(&walk);
            self.closed = wrong.is_empty() && self.drawn(&walk).iter().all(|&times| times == 1);
            if self.closed {
                self.best = Some((cheapest.bound, walk));
                break;
            }
            if round + 1 == rounds {
                break;
            }
            let on = self.states.costs_on(&self.poses, &cheapest);
            let left = limit.map_or(i64::MAX, |limit| limit - 1 - cheapest.bound);
            let few = self.states.trimmed(&self.poses, &cheapest, &on, left.min(slack as i64));
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
        let shrink = LAST.powf(1.0 / (steps * self.budget.rounds) as f64);
        let mut splits = 0;
        let mut alpha = 1.0;
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
            self.repeated(&walk, faults);
            if let Some(limit) = limit {
                let square: i32 = drawn.iter().map(|&times| (1 - times) * (1 - times)).sum();
                *step = alpha * (limit - cheapest.bound).max(0) as f64 / f64::from(square);
                alpha *= 0.95;
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
        match self.states.refined(&self.blocks, &remembered, self.budget.pairs) {
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
