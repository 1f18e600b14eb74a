//! Relaxed walks: a bound for layers of which every loop is entered and left at one place.
//!
//! A relaxed walk draws as many paths as the layer has, from a place to a place, run by run, and leaves each loop where it entered
//! it. It may draw a path twice if it has forgotten the first time: at each path it remembers only those nearby (the ng-routes
//! of Baldacci, Mingozzi & Roberti 2011, <https://doi.org/10.1287/opre.1110.0975>, a relaxation of the state space as by
//! Christofides, Mingozzi & Toth 1981, <https://doi.org/10.1002/net.3230110207>). Multipliers reward paths that are drawn too
//! seldom. Every walk that the problem permits is among the relaxed ones, so the cheapest is no more expensive than the shortest.
//! Where the cheapest draws everything once it is an optimum.

mod blocks;
mod climb;
mod costs;
mod poses;
mod states;

use super::model::Model;
use crate::{Sequence, Visit};
use blocks::Blocks;
pub(super) use blocks::MOST;
use blocks::Set;
pub(super) use climb::Budget;
use costs::FAR;
use pathwright_geometry::Point;
use poses::Poses;
use states::{Cheapest, States, Walk};

/// The relaxed walks of a layer, and their multipliers.
pub(super) struct Walks<'a> {
    model: &'a Model,
    /// Layer of each path, if there are several.
    layer_of: Vec<u32>,
    blocks: Blocks,
    poses: Poses,
    /// What is remembered at each path.
    remembered: Vec<Set>,
    states: States,
    /// What a link into the layer and one out of it costs at each point.
    links: [Vec<i64>; 2],
    /// What each path takes off.
    multipliers: Vec<i64>,
    pub(super) bound: i64,
    /// Whether no walk is shorter than some that the problem permits.
    pub(super) closed: bool,
    budget: Budget,
    /// The mean of the first multipliers.
    step: f64,
    /// Walks that cost so much were left out.
    limit: Option<i64>,
    /// Whether multipliers were sought before.
    climbed: bool,
    /// The cheapest walk, if it draws everything once and crosses nothing.
    best: Option<(i64, Walk)>,
}

/// A layer's share: its own, and what links pay at either side.
pub(super) type Settled = (i64, [Vec<(Point, i64)>; 2]);

impl<'a> Walks<'a> {
    /// Links at both ends of walks cost nothing until [`Self::measure`]. `multipliers` are a first guess. `None` if there are too many
    /// walks to look at.
    pub(super) fn new(model: &'a Model, multipliers: Vec<i64>, budget: Budget) -> Option<Self> {
        let layer_of = vec![0; model.bodies.len()];
        let blocks = Blocks::new(model, &layer_of, budget.memories, budget.turns)?;
        let poses = Poses::new(model, budget.vertices)?;
        let remembered = remembered(&blocks, &poses, model.bodies.len());
        let states = States::new(&blocks, &remembered, budget.pairs)?;
        let points = model.points.len();
        let step = multipliers.iter().sum::<i64>() as f64 / multipliers.len().max(1) as f64;
        let walks = Self {
            model,
            layer_of,
            blocks,
            poses,
            remembered,
            states,
            links: [vec![0; points], vec![0; points]],
            multipliers,
            bound: 0,
            closed: false,
            budget,
            step,
            climbed: false,
            best: None,
            limit: None,
        };
        // A few looks at them all are the least that is of use.
        let enough = budget.work * model.bodies.len() as u64;
        Some(walks).filter(|walks| LEAST_LOOKS * walks.work(&walks.states) <= enough)
    }

    /// The walks of several layers, one after the other, with what was found for each.
    pub(super) fn joined(model: &'a Model, layers: &[&Self], budget: Budget) -> Option<Self> {
        let layer_of: Vec<u32> =
            (0..).zip(layers).flat_map(|(k, layer)| vec![k; layer.multipliers.len()]).collect();
        let blocks = Blocks::new(model, &layer_of, budget.memories, budget.turns)?;
        let remembered: Vec<Set> = layers.iter().flat_map(|layer| layer.remembered.iter().copied()).collect();
        let states = States::new(&blocks, &remembered, budget.pairs)?;
        let poses = Poses::joined(model, layers.iter().map(|layer| &layer.poses));
        let multipliers: Vec<i64> =
            layers.iter().flat_map(|layer| layer.multipliers.iter().copied()).collect();
        let step = layers.iter().map(|layer| layer.step).sum::<f64>() / layers.len().max(1) as f64;
        let points = model.points.len();
        Some(Self {
            model,
            layer_of,
            blocks,
            poses,
            remembered,
            states,
            links: [vec![0; points], vec![0; points]],
            multipliers,
            bound: 0,
            closed: false,
            budget,
            step,
            climbed: true,
            best: None,
            limit: None,
        })
    }

    /// Makes the link from where the walk comes from (0) or to where it continues (1) part of the bound; `cost` is the
    /// least for a point.
    pub(super) fn measure(&mut self, side: usize, cost: impl Fn(Point) -> i64) {
        self.links[side] = self.model.points.iter().map(|&p| cost(p)).collect();
    }

    /// The cheapest walk as a solution, if it draws everything once and leaves every loop where it is entered.
    pub(super) fn solution(&self) -> Option<Sequence> {
        let (_, walk) = self.best.as_ref()?;
        let entry = |k: usize, pose: usize| {
            let range = self.poses.range(pose, 0);
            let at = match k {
                _ if range.len() == 1 => range.start,
                0 => self.link(pose, 0).1,
                _ => self.poses.joint(self.model, walk[k - 1], pose).1,
            };
            Visit { item: self.poses.item_of(pose), entry: at as u32 }
        };
        Some(walk.iter().enumerate().map(|(k, &pose)| entry(k, pose)).collect())
    }

    /// For each layer, the bound without the links in and out, and the price of links at each point where a walk may begin or end: at
    /// its end what it takes to come there, at its beginning the same taken off; if `down`, what it takes to go on from its beginning, and
    /// from its end the same taken off.
    pub(super) fn settle(&self, down: bool) -> Vec<Settled> {
        let cheapest = self.cheapest(&self.states, &self.multipliers);
        let passages = self.states.passages(&self.poses, &cheapest, down);
        let layers = self.layer_of.last().map_or(0, |&last| last as usize + 1);
        let mut settled: Vec<Settled> = vec![Default::default(); layers];
        for (&layer, multiplier) in self.layer_of.iter().zip(&self.multipliers) {
            settled[layer as usize].0 += multiplier;
        }
        if let Some(limit) = self.limit {
            return vec![self.settle_limited(limit, settled[0].0, &cheapest, &passages[1])];
        }
        for (side, passages) in passages.iter().enumerate() {
            let off = if (side == 0) == down { 1 } else { -1 };
            for (pose, &passage) in passages.iter().enumerate().filter(|&(_, &passage)| passage < FAR / 2.0) {
                let layer = self.layer_of[self.poses.item_of(pose) as usize];
                let points = self.poses.points(self.model, pose, side).iter();
                settled[layer as usize].1[side].extend(points.map(|&p| (p, off * passage as i64)));
            }
        }
        settled
    }

    /// The same for one layer, some of whose walks were left out: one that ended with a pose cost the limit at least, and costs
    /// that without the link out when it comes to the pose.
    fn settle_limited(&self, limit: i64, inner: i64, cheapest: &Cheapest, ends: &[f64]) -> Settled {
        let mut settled: Settled = (inner, Default::default());
        for (pose, &end) in ends.iter().enumerate() {
            let item = self.poses.item_of(pose);
            let mut add = |side: usize, price: i64| {
                let points = self.poses.points(self.model, pose, side).iter();
                settled.1[side].extend(points.map(|&p| (p, price)));
            };
            if self.model.may_begin(item) {
                add(0, -(cheapest.enter[pose] as i64));
            }
            if self.model.may_end(item) {
                add(1, (end as i64).min(limit - cheapest.exit[pose] as i64 - inner));
            }
        }
        settled
    }

    /// The least cost of a link into or out of the layer at a pose, and the number of the point, among its path's, where it ends.
    fn link(&self, pose: usize, side: usize) -> (i64, usize) {
        let first = self.model.range_of_item(self.poses.item_of(pose)).start;
        self.poses
            .range(pose, side)
            .map(|at| (self.links[side][first + at], at))
            .min()
            .unwrap_or((FAR as i64, 0))
    }

    fn cheapest(&self, states: &States, multipliers: &[i64]) -> Cheapest {
        let pays: Vec<f64> = multipliers.iter().map(|&multiplier| -multiplier as f64).collect();
        let link = |pose: usize, side: usize| self.link(pose, side).0 as f64;
        let [enter, exit] =
            [0, 1].map(|side| (0..self.poses.count()).map(|pose| link(pose, side)).collect::<Vec<_>>());
        let costs = states.costs(&self.poses, &enter, &pays);
        let ends = states.ends(&self.poses, &costs);
        let whole = (0..ends.len()).map(|pose| (ends[pose] + exit[pose], pose));
        let (least, last) = whole.reduce(|a, b| if b.0 < a.0 { b } else { a }).unwrap_or((0.0, 0));
        let bound = least as i64 + multipliers.iter().sum::<i64>();
        Cheapest { bound, pays, enter, exit, costs, ends, last }
    }

    /// The vertices at which a walk enters and leaves loops, by path, where these differ.
    fn crossed(&self, walk: &Walk) -> Vec<(u32, usize)> {
        let mut crossed = Vec::new();
        for (k, &pose) in walk.iter().enumerate().filter(|&(_, &pose)| self.poses.range(pose, 0).len() > 1) {
            let enter = match k {
                0 => self.link(pose, 0).1,
                _ => self.poses.joint(self.model, walk[k - 1], pose).1,
            };
            let leave = match walk.get(k + 1) {
                None => self.link(pose, 1).1,
                Some(&next) => self.poses.joint(self.model, pose, next).0,
            };
            if enter != leave {
                let item = self.poses.item_of(pose);
                crossed.extend([(item, enter), (item, leave)]);
            }
        }
        crossed
    }
}

/// Looks at all walks for which there must be time.
const LEAST_LOOKS: u64 = 10;
/// Paths of a block in which walks remember all.
const ALL: usize = 6;
/// Others that are remembered at first in larger ones.
const NEAR: usize = 3;

/// The paths nearest to each, and itself, numbered within their block.
fn remembered(blocks: &Blocks, poses: &Poses, paths: usize) -> Vec<Set> {
    let mut remembered = vec![0; paths];
    for items in &blocks.items {
        for (k, &item) in items.iter().enumerate() {
            let mut others: Vec<usize> = (0..items.len()).filter(|&other| other != k).collect();
            let far = |other: usize| poses.least_to(items[other])[item as usize];
            others.sort_by(|&a, &b| far(a).total_cmp(&far(b)));
            others.truncate(if items.len() <= ALL { ALL } else { NEAR });
            remembered[item as usize] = others.iter().fold(1 << k, |set: Set, other| set | 1 << other);
        }
    }
    remembered
}
