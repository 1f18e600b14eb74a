//! Relaxed walks of a layer as ways through a graph without circles.

use rustc_hash::FxHashMap;

use super::blocks::{Blocks, Set};
use super::costs::{FAR, greatest, least, lower};
use super::poses::Poses;
use pathwright_geometry::real;

/// A path being drawn, after so many of its block, and what is remembered of those before it.
struct State {
    item: u32,
    /// Paths of its block that are known to be drawn, and blocks.
    known: Set,
    done: Set,
    /// Whether it is the first of its block, or the last.
    first: bool,
    last: bool,
    /// Whether it is the first of its layer, or the last.
    opens: bool,
    closes: bool,
    /// Whether it is the first of all, or the last.
    begins: bool,
    ends: bool,
    /// States that may come before: a piece of the list of all these.
    from: (u32, u32),
}

/// The graph.
pub(super) struct States {
    states: Vec<State>,
    from: Vec<u32>,
}

/// A walk: poses, in order.
pub(super) type Walk = Vec<usize>;

/// The cheapest relaxed walks under some multipliers.
pub(super) struct Cheapest {
    pub(super) pays: Vec<f64>,
    pub(super) enter: Vec<f64>,
    pub(super) exit: Vec<f64>,
    pub(super) costs: Costs,
    /// To each pose, as the last.
    pub(super) ends: Vec<f64>,
    pub(super) last: usize,
    pub(super) bound: i64,
}

impl States {
    /// The walks that remember at each path those in its set of `remembered`, paths being numbered within their blocks. `None` if
    /// there are more than so many pairs of states.
    pub(super) fn new(blocks: &Blocks, remembered: &[Set], most: usize) -> Option<Self> {
        let mut states: Vec<State> = Vec::new();
        let mut into: Vec<Vec<u32>> = Vec::new();
        let mut pairs = 0;
        // States with which each turn ends, once begun.
        let mut before: Vec<Vec<u32>> = vec![Vec::new(); blocks.turns.len()];
        for (number, turn) in blocks.turns.iter().enumerate() {
            let items = &blocks.items[turn.block as usize];
            let open = std::mem::take(&mut before[number]);
            if open.is_empty() && turn.place > 0 {
                continue;
            }
            let mut now: Vec<(usize, Set, u32)> = Vec::new();
            for place in 0..items.len() {
                let last = place + 1 == items.len();
                let mut next: Vec<(usize, Set, u32)> = Vec::new();
                let mut numbers = FxHashMap::default();
                let mut reach = |k: usize, known: Set, from: &[u32]| {
                    // What was drawn of a block does not count when it is left.
                    let known = if last { 0 } else { known & remembered[items[k] as usize] | 1 << k };
                    let state = *numbers.entry((k, known)).or_insert_with(|| {
                        states.push(State {
                            item: items[k],
                            known,
                            done: turn.done,
                            first: place == 0,
                            last,
                            opens: place == 0 && blocks.below.contains(&turn.place),
                            closes: last && blocks.below.contains(&(turn.place + 1)),
                            begins: place == 0 && turn.place == 0,
                            ends: last && turn.place + 1 == blocks.items.len(),
                            from: (0, 0),
                        });
                        into.push(Vec::new());
                        next.push((k, known, states.len() as u32 - 1));
                        states.len() as u32 - 1
                    });
                    into[state as usize].extend(from);
                    pairs += from.len();
                };
                for k in 0..items.len() {
                    if place == 0 {
                        reach(k, 0, &open);
                    }
                    for &(_, known, from) in now.iter().filter(|(_, known, _)| known >> k & 1 == 0) {
                        reach(k, known, &[from]);
                    }
                }
                if pairs > most {
                    return None;
                }
                now = next;
            }
            for &next in &turn.next {
                before[next as usize].extend(now.iter().map(|&(_, _, state)| state));
            }
        }
        Some(Self::of(states, &into))
    }

    /// States, and those that may come before each.
    fn of(mut states: Vec<State>, into: &[Vec<u32>]) -> Self {
        let mut from = Vec::with_capacity(into.iter().map(Vec::len).sum());
        for (state, into) in states.iter_mut().zip(into) {
            state.from.0 = from.len() as u32;
            from.extend(into);
            state.from.1 = from.len() as u32;
        }
        Self { states, from }
    }

    /// The walks of this graph that remember more, if all that they have is remembered. `None` if there are more than so many pairs of
    /// states.
    pub(super) fn refined(&self, blocks: &Blocks, remembered: &[Set], most: usize) -> Option<Self> {
        let mut states: Vec<State> = Vec::new();
        let mut into: Vec<Vec<u32>> = Vec::new();
        let mut pairs = 0;
        // The states that each becomes: `first..last`.
        let mut became: Vec<(u32, u32)> = Vec::with_capacity(self.states.len());
        let mut numbers = FxHashMap::default();
        for old in &self.states {
            let begin = states.len() as u32;
            let (block, nth) = (blocks.of[old.item as usize] as usize, blocks.nth[old.item as usize]);
            numbers.clear();
            let mut reach = |states: &mut Vec<State>, known: Set, done: Set, from: Option<u32>| {
                let known = if old.last { 0 } else { known & remembered[old.item as usize] | 1 << nth };
                let number = *numbers.entry((known, done)).or_insert_with(|| {
                    states.push(State { known, done, ..*old });
                    into.push(Vec::new());
                    states.len() as u32 - 1
                });
                into[number as usize].extend(from);
                pairs += 1;
            };
            if old.begins {
                reach(&mut states, 0, blocks.after(0, block), None);
            }
            for &from in &self.from[old.from.0 as usize..old.from.1 as usize] {
                let (first, last) = became[from as usize];
                for from in first..last {
                    let State { known, done, .. } = states[from as usize];
                    if old.first && done >> block & 1 == 0 {
                        reach(&mut states, 0, blocks.after(done, block), Some(from));
                    } else if !old.first && known >> nth & 1 == 0 {
                        reach(&mut states, known, done, Some(from));
                    }
                }
            }
            if pairs > most {
                return None;
            }
            became.push((begin, states.len() as u32));
        }
        Some(Self::of(states, &into))
    }

    /// The number of pairs of states of which one may come before the other.
    pub(super) fn pairs(&self) -> usize {
        self.from.len()
    }

    /// What the cheapest walk to each pose of each state costs, state after state. A walk pays `enter` at the first pose, the links, and
    /// `pays` for each path.
    pub(super) fn costs(&self, poses: &Poses, enter: &[f64], pays: &[f64]) -> Costs {
        let mut first = Vec::with_capacity(self.states.len());
        let mut costs: Vec<f64> = Vec::new();
        // The least cost of each state, and its path.
        let mut leasts: Vec<(f64, u32)> = Vec::with_capacity(self.states.len());
        let mut promises: Vec<f64> = Vec::new();
        for state in &self.states {
            let own = poses.of(state.item);
            let begin = costs.len();
            first.push(begin as u32);
            if state.begins {
                costs.extend(&enter[own.clone()]);
            } else {
                costs.resize(begin + own.len(), FAR);
            }
            let (earlier, here) = costs.split_at_mut(begin);
            let mut worst = greatest(here);
            let before = &self.from[state.from.0 as usize..state.from.1 as usize];
            let (from_items, from_poses) = (poses.least_to(state.item), poses.to_item(state.item));
            promises.clear();
            promises.extend(before.iter().map(|&from| {
                let (least, item) = leasts[from as usize];
                least + from_items[item as usize]
            }));
            // The most promising first: it shows that most others cannot do better anywhere.
            let best = (0..before.len()).reduce(|a, b| if promises[b] < promises[a] { b } else { a });
            for k in best.into_iter().chain(0..before.len()) {
                if promises[k] >= worst {
                    continue;
                }
                let from = before[k] as usize;
                let other = poses.of(leasts[from].1);
                let far = &earlier[first[from] as usize..][..other.len()];
                for ((p, &so_far), to_here) in other.clone().zip(far).zip(&from_poses[other]) {
                    if so_far + to_here >= worst {
                        continue;
                    }
                    lower(here, so_far, &poses.from(p)[own.clone()]);
                    worst = greatest(here);
                }
            }
            let pay = pays[state.item as usize];
            here.iter_mut().for_each(|cost| *cost += pay);
            leasts.push((least(here.iter().copied()), state.item));
        }
        Costs { first, costs }
    }

    /// The same from each pose of each state, itself not counted, to the end, where it pays `exit`.
    pub(super) fn costs_on(&self, poses: &Poses, cheapest: &Cheapest) -> Vec<f64> {
        let Cheapest { pays, exit, costs: there, .. } = cheapest;
        let mut costs = vec![FAR; there.costs.len()];
        for (state, &first) in self.states.iter().zip(&there.first).rev() {
            let own = poses.of(state.item);
            let (before, here) = costs.split_at_mut(first as usize);
            let here = &mut here[..own.len()];
            if state.ends {
                here.copy_from_slice(&exit[own.clone()]);
            }
            let least_on = least(here.iter().copied());
            for &from in &self.from[state.from.0 as usize..state.from.1 as usize] {
                let item = self.states[from as usize].item;
                let other = poses.of(item);
                let far = &mut before[there.first[from as usize] as usize..][..other.len()];
                let pay = pays[state.item as usize];
                for (p, cost) in other.zip(far) {
                    if poses.to_item(state.item)[p] + least_on + pay < *cost {
                        let on =
                            poses.from(p)[own.clone()].iter().zip(&*here).map(|(length, on)| length + on);
                        *cost = real::lesser(pay + least(on), *cost);
                    }
                }
            }
        }
        costs
    }

    /// The part of the graph through which walks lead that cost little more than the cheapest.
    pub(super) fn trimmed(&self, poses: &Poses, cheapest: &Cheapest, on: &[f64], slack: f64) -> Self {
        let Cheapest { pays, exit, costs, ends, last, .. } = cheapest;
        let first = &costs.first;
        let limit = ends[*last] + exit[*last] + slack;
        let least_of = |values: &dyn Fn(usize) -> f64, state: usize| {
            let first = costs.first[state] as usize;
            least((first..first + poses.of(self.states[state].item).len()).map(values))
        };
        let leads = |from: usize, to: usize, limit: f64| {
            let (a, b) = (poses.of(self.states[from].item), poses.of(self.states[to].item));
            let costs = &costs.costs[costs.first[from] as usize..];
            let on = &on[first[to] as usize..][..b.len()];
            a.zip(costs).any(|(p, cost)| {
                poses.from(p)[b.clone()].iter().zip(on).any(|(length, on)| cost + length + on <= limit)
            })
        };
        let mut number = vec![u32::MAX; self.states.len()];
        let (mut states, mut from): (Vec<State>, Vec<u32>) = (Vec::new(), Vec::new());
        for (k, state) in self.states.iter().enumerate() {
            if least_of(&|at| costs.costs[at] + on[at], k) > limit {
                continue;
            }
            let to = least_of(&|at| on[at], k) + pays[state.item as usize];
            number[k] = states.len() as u32;
            let begin = from.len() as u32;
            for &other in &self.from[state.from.0 as usize..state.from.1 as usize] {
                if number[other as usize] == u32::MAX {
                    continue;
                }
                let link = poses.least_to(state.item)[self.states[other as usize].item as usize];
                if least_of(&|at| costs.costs[at], other as usize) + link + to <= limit
                    && leads(other as usize, k, limit - pays[state.item as usize])
                {
                    from.push(number[other as usize]);
                }
            }
            states.push(State { from: (begin, from.len() as u32), ..*state });
        }
        Self { states, from }
    }

    /// What the cheapest walk that ends with each pose costs.
    pub(super) fn ends(&self, poses: &Poses, costs: &Costs) -> Vec<f64> {
        let mut ends = vec![FAR; poses.count()];
        for (state, &first) in self.states.iter().zip(&costs.first).filter(|(state, _)| state.ends) {
            let own = poses.of(state.item);
            let here = &costs.costs[first as usize..][..own.len()];
            own.zip(here).for_each(|(pose, &cost)| ends[pose] = real::lesser(cost, ends[pose]));
        }
        ends
    }

    /// What it takes to come to each pose as the first of its layer, and what to draw all paths from there to the last of the layer;
    /// if `down`, what it takes to go on from the first pose, and from the last.
    pub(super) fn passages(&self, poses: &Poses, cheapest: &Cheapest, down: bool) -> [Vec<f64>; 2] {
        let Cheapest { pays, costs, .. } = cheapest;
        let on = down.then(|| self.costs_on(poses, cheapest));
        let mut passages = [vec![FAR; poses.count()], vec![FAR; poses.count()]];
        for (state, &first) in self.states.iter().zip(&costs.first) {
            let pay = pays[state.item as usize];
            let own = poses.of(state.item);
            let values = &on.as_ref().unwrap_or(&costs.costs)[first as usize..][..own.len()];
            // What is drawn counts between the two.
            let counted = if down { pay } else { -pay };
            for (side, counted) in
                [(0, counted), (1, 0.0)].into_iter().filter(|&(side, _)| [state.opens, state.closes][side])
            {
                for (pose, &value) in own.clone().zip(values) {
                    let passage = &mut passages[side][pose];
                    // What is taken off must not be too little.
                    let known = *passage < FAR / 2.0;
                    *passage = if known && down && side == 1 {
                        real::greater(value, *passage)
                    } else {
                        real::lesser(value + counted, *passage)
                    };
                }
            }
        }
        passages
    }

    /// A cheapest walk.
    pub(super) fn walk(&self, poses: &Poses, cheapest: &Cheapest) -> Walk {
        let Cheapest { pays, enter, costs, ends, last, .. } = cheapest;
        let value = |state: usize, pose: usize| {
            costs.costs[costs.first[state] as usize + pose - poses.of(self.states[state].item).start]
        };
        let is_last = |&state: &usize| {
            self.states[state].ends
                && self.states[state].item == poses.item_of(*last)
                && value(state, *last) == ends[*last]
        };
        let (mut pose, mut walk) = (*last, vec![*last]);
        let Some(mut state) = (0..self.states.len()).rev().find(is_last) else { return Vec::new() };
        loop {
            let at = &self.states[state];
            let left = value(state, pose) - pays[at.item as usize];
            if at.begins && enter[pose] == left {
                break;
            }
            let before = &self.from[at.from.0 as usize..at.from.1 as usize];
            let found = before.iter().find_map(|&from| {
                let mut poses_before = poses.of(self.states[from as usize].item);
                let p = poses_before.find(|&p| value(from as usize, p) + poses.from(p)[pose] == left)?;
                Some((from as usize, p))
            });
            let Some(found) = found else { break };
            (state, pose) = found;
            walk.push(pose);
        }
        walk.reverse();
        walk
    }
}

/// See [`States::costs`].
pub(super) struct Costs {
    /// First cost of each state.
    first: Vec<u32>,
    costs: Vec<f64>,
}
