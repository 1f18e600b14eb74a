//! The ascent of relaxed walks.

use pathwright_geometry::real;

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
}

impl Walks<'_> {
    /// Seeks better multipliers, and divides loops and remembers paths where the cheapest walks cheat.
    pub(in super::super) fn climb(&mut self) {
        let count = self.model.bodies.len();
        let mut slack = SLACK * self.step * count as f64;
        let mut step = self.step * if self.climbed { AGAIN } else { FIRST };
        self.climbed = true;
        let mut now = self.multipliers.clone();
        let mut proved = i64::MIN;
        let mut work = self.budget.work * count as u64;
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
            let walk = self.walk(&self.states, &cheapest);
            let wrong = self.crossed(&walk);
            self.closed = wrong.is_empty() && self.drawn(&walk).iter().all(|&times| times == 1);
            if self.closed || round + 1 == self.budget.rounds {
                break;
            }
            let few = self.states.trimmed(&self.poses, &cheapest, slack as i64);
            let spent = LOOKS * self.work(&self.states) + self.budget.steps as u64 * self.work(&few);
            if spent > work {
                break;
            }
            work -= spent;
            let mut faults = Faults { crossed: wrong, repeated: Vec::new() };
            now = self.climb_few(&few, &now, &mut step, &mut faults);
            self.mend(&faults);
        }
        self.bound = proved;
    }

    /// The best multipliers for the walks of a part of the graph, from those given.
    fn climb_few(&mut self, few: &States, from: &[i64], step: &mut f64, faults: &mut Faults) -> Vec<i64> {
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
            self.repeated(&walk, &mut faults.repeated);
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

    /// Paths that a walk draws again in one block, and those in between.
    fn repeated(&self, walk: &Walk, repeated: &mut Vec<(u32, Vec<u32>)>) {
        let items: Vec<u32> = walk.iter().map(|&pose| self.poses.item_of(pose)).collect();
        for (k, &item) in items.iter().enumerate() {
            let before = &items[k.saturating_sub(LONG)..k];
            let Some(back) = before.iter().rposition(|&other| other == item) else { continue };
            let between = &before[back + 1..];
            let block = self.blocks.of[item as usize];
            if between.iter().all(|&other| self.blocks.of[other as usize] == block) {
                repeated.push((item, between.to_vec()));
            }
        }
    }

    /// Divides loops, and remembers paths, where walks cheated.
    fn mend(&mut self, faults: &Faults) {
        self.poses.split(self.model, &faults.crossed);
        let mut remembered = self.remembered.clone();
        for (item, between) in &faults.repeated {
            let nth = self.blocks.nth[*item as usize];
            between.iter().for_each(|&other| remembered[other as usize] |= (1 as Set) << nth);
        }
        if remembered != self.remembered
            && let Some(states) = States::new(&self.blocks, &remembered, self.budget.pairs)
        {
            (self.states, self.remembered) = (states, remembered);
        }
    }

    /// What it takes to look at all walks of a graph, about.
    pub(super) fn work(&self, states: &States) -> u64 {
        let poses = (self.poses.count() / self.model.bodies.len().max(1)) as u64;
        states.pairs() as u64 * (8 + poses)
    }
}
