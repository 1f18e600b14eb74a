//! The relaxation of one layer: a tree instead of a walk, with multipliers on the constraints that a tree may
//! violate.

use rustc_hash::{FxHashMap, FxHashSet};

use super::super::matching::delaunay;
use super::cuts::{Cuts, common};
use super::directions::{Directions, RUNS};
use super::link::Link;
use super::model::{Body, DEPTHS, Model};
use super::passages::{Fares, Passage};
use super::pricing::{Priced, Prices, Pricing};
use super::tree::{Forest, Usage};
#[cfg(feature = "highs")]
use crate::Visit;
use pathwright_geometry::DisjointSets;
use pathwright_geometry::Point;

/// The prices, in fine units.
#[derive(Clone)]
pub(super) struct Multipliers {
    /// For each link at a terminal, of either sign.
    pub(super) nodes: Vec<i64>,
    /// For each cut that no link leaves, not negative.
    pub(super) cuts: Vec<i64>,
    /// For a link from one neighbour at one piece of a loop that is not entered there, not negative. Number 0 stands for
    /// no tie and costs nothing.
    pub(super) ties: Vec<i64>,
    /// For the link into each run and for the one out of it, of either sign; none where links have no directions.
    pub(super) runs: Vec<[i64; 2]>,
    /// For each passage that is not made, not negative.
    pub(super) passages: Vec<i64>,
}

/// What links pay besides their cost.
pub(super) struct Weights {
    /// At each terminal; the last is what the link from the start pays there.
    terminals: Vec<i64>,
    /// Between runs, if links there have directions.
    fares: Option<Fares>,
}

impl Weights {
    pub(super) fn at(&self, terminal: u32) -> i64 {
        self.terminals[terminal as usize]
    }

    pub(super) fn fares(&self) -> Option<&Fares> {
        self.fares.as_ref()
    }
}

/// A terminal where a walk may begin or end.
#[derive(Clone, Copy)]
pub(super) struct WalkEnd {
    pub(super) terminal: u32,
    pub(super) tie: u32,
    /// Of the link there, in fine units.
    pub(super) cost: i64,
    /// Cuts that hold both this and the start: a piece of the list of all shared cuts.
    shared: (u32, u32),
    /// Trees since the last look that used it.
    used: u32,
}

/// See the module.
pub(super) struct Relaxation<'a> {
    pub(super) model: &'a Model,
    pricing: Pricing<'a>,
    pub(super) directions: Option<Directions>,
    /// The known links, by depth, and the terminals that they join.
    pub(super) links: [Vec<Link>; DEPTHS],
    known: FxHashSet<(u32, u32)>,
    /// Paths with known links.
    pairs: FxHashSet<(u32, u32)>,
    pub(super) cuts: Cuts,
    /// None where links have no directions.
    pub(super) passages: Vec<Passage>,
    /// For [`Link::shared`].
    shared: Vec<u32>,
    /// For each loop in several pieces, and each neighbour, the first of as many ties.
    pub(super) blocks: Vec<Vec<u32>>,
    block_of: FxHashMap<(u32, u32), u32>,
    pub(super) ties: usize,
    /// Where the walk may begin, and where it may end.
    pub(super) walk_ends: [Vec<WalkEnd>; 2],
    keys: Vec<(i64, u32)>,
}

impl<'a> Relaxation<'a> {
    /// Links at both ends of the walk cost nothing until [`Self::measure`].
    pub(super) fn new(model: &'a Model) -> Self {
        let mut relaxation = Self::bare(model);
        relaxation.add_neighbours();
        let (_, tree) = relaxation.exact(&relaxation.zero());
        relaxation.add_tree(&tree);
        relaxation
    }

    /// As [`Self::new`], without any known links.
    pub(super) fn bare(model: &'a Model) -> Self {
        let mut relaxation = Self {
            model,
            pricing: Pricing::new(model),
            directions: Directions::new(model),
            links: Default::default(),
            known: FxHashSet::default(),
            pairs: FxHashSet::default(),
            cuts: Cuts::new(model.terminals.len()),
            passages: Vec::new(),
            shared: Vec::new(),
            blocks: vec![Vec::new(); model.bodies.len()],
            block_of: FxHashMap::default(),
            ties: 1,
            walk_ends: Default::default(),
            keys: Vec::new(),
        };
        for item in 0..model.bodies.len() as u32 {
            for (side, permitted) in [model.may_begin(item), model.may_end(item)].into_iter().enumerate() {
                if permitted {
                    let block = relaxation.add_block(item);
                    let body = &model.bodies[item as usize];
                    relaxation.walk_ends[side].extend((body.first..body.last).map(|terminal| WalkEnd {
                        terminal,
                        tie: tie(block, terminal - body.first),
                        cost: 0,
                        shared: (0, 0),
                        used: 0,
                    }));
                }
            }
        }
        relaxation
    }

    /// Multipliers that do nothing.
    pub(super) fn zero(&self) -> Multipliers {
        Multipliers {
            nodes: vec![0; self.model.terminals.len()],
            cuts: vec![0; self.cuts.members.len()],
            ties: vec![0; self.ties],
            runs: vec![[0; 2]; self.directions.as_ref().map_or(0, Directions::count)],
            passages: vec![0; self.passages.len()],
        }
    }

    /// Makes the link from where the walk comes from (0) or to where it continues (1) part of the bound; `cost` is the
    /// least for a point.
    pub(super) fn measure(&mut self, side: usize, cost: impl Fn(Point) -> i64) {
        for end in &mut self.walk_ends[side] {
            end.cost = self.model.points_of(end.terminal).iter().map(|&p| cost(p)).min().unwrap_or(0);
        }
    }

    /// Pairs of paths that a Delaunay edge joins, in every family of siblings.
    fn add_neighbours(&mut self) {
        let model = self.model;
        let mut pairs = Vec::new();
        for points in self.pricing.families() {
            let positions: Vec<Point> = points.iter().map(|&point| model.points[point as usize]).collect();
            let owner = |k: u32| model.owner[points[k as usize] as usize];
            pairs.extend(delaunay(&positions).into_iter().map(|(u, v)| (owner(u), owner(v))));
        }
        for (a, b) in pairs {
            self.add_pair(a, b);
        }
    }

    /// Makes the pairs that a tree joins known; whether any link was new.
    pub(super) fn add_tree(&mut self, tree: &[Priced]) -> bool {
        let before = self.known.len();
        for found in tree {
            let [a, b] = [found.from, found.to].map(|point| self.model.owner[point as usize]);
            self.add_pair(a, b);
        }
        self.known.len() > before
    }

    /// Makes the link of two terminals known and, if it is the first between their paths, all others there between single
    /// points, and from each piece of a loop that to the nearest terminal.
    fn add_pair(&mut self, a: u32, b: u32) {
        let model = self.model;
        let [i, j] = [a, b].map(|t| model.terminals[t as usize].item);
        if i == j || !model.permits(i, j) {
            return;
        }
        self.add_link(a, b);
        if !self.pairs.insert((i.min(j), i.max(j))) {
            return;
        }
        let [one, other] =
            [i, j].map(|item| model.bodies[item as usize].first..model.bodies[item as usize].last);
        let few = one.len() <= 2 && other.len() <= 2;
        for (from, to) in [(one.clone(), other.clone()), (other, one)] {
            for a in from {
                let nearest = to.clone().min_by_key(|&b| (model.cheapest(a, b), b));
                to.clone().filter(|&b| few || nearest == Some(b)).for_each(|b| self.add_link(a, b));
            }
        }
    }

    pub(super) fn add_link(&mut self, a: u32, b: u32) {
        let model = self.model;
        let (a, b) = (a.min(b), a.max(b));
        let [i, j] = [a, b].map(|t| model.terminals[t as usize].item);
        if !self.known.insert((a, b)) {
            return;
        }
        let blocks = [self.block(i, j), self.block(j, i)];
        let first = self.shared.len() as u32;
        self.shared.extend(self.cuts.shared(a, b));
        self.links[model.depth(i, j)].push(Link {
            cost: model.cheapest(a, b),
            a,
            b,
            ties: [
                tie(blocks[0], a - model.bodies[i as usize].first),
                tie(blocks[1], b - model.bodies[j as usize].first),
            ],
            shared: (first, self.shared.len() as u32),
            used: 0,
        });
    }

    /// What a link pays for its tie at `a`.
    pub(super) fn tied(&self, a: u32, b: u32, multipliers: &Multipliers) -> i64 {
        let [i, j] = [a, b].map(|t| self.model.terminals[t as usize].item);
        if self.blocks[i as usize].is_empty() {
            return 0;
        }
        let block = self.block_of.get(&(i, j)).copied().unwrap_or(0);
        multipliers.ties[tie(block, a - self.model.bodies[i as usize].first) as usize]
    }

    /// The block of a loop's ties for one neighbour.
    fn block(&mut self, item: u32, neighbour: u32) -> u32 {
        if let Some(&block) = self.block_of.get(&(item, neighbour)) {
            return block;
        }
        let block = self.add_block(item);
        self.block_of.insert((item, neighbour), block);
        block
    }

    /// Ties for the links from one neighbour to each piece of a loop; 0 for paths that are of one piece.
    fn add_block(&mut self, item: u32) -> u32 {
        let body = &self.model.bodies[item as usize];
        if !body.is_split() {
            return 0;
        }
        let block = self.ties as u32;
        self.ties += (body.last - body.first) as usize;
        self.blocks[item as usize].push(block);
        block
    }

    /// Looks for cuts that the trees since the last look violate on average; whether there are new ones.
    pub(super) fn look_for_cuts(&mut self, trees: u32) -> bool {
        let before = self.cuts.members.len();
        let links = self.links.concat();
        self.cuts.separate_parts(self.model, &links, trees);
        let used =
            |ends: &Vec<WalkEnd>| -> Vec<_> { ends.iter().map(|end| (end.terminal, end.used)).collect() };
        let [begun, ended] = self.walk_ends.each_ref().map(used);
        self.cuts.separate_precedence(self.model, &links, [&begun, &ended], trees);
        self.forget_trees();
        let grown = self.cuts.members.len() > before;
        if grown {
            self.share_cuts();
        }
        grown
    }

    /// Begins to count anew how often trees use links.
    pub(super) fn forget_trees(&mut self) {
        self.walk_ends.iter_mut().flatten().for_each(|end| end.used = 0);
        self.links.iter_mut().flatten().for_each(|link| link.used = 0);
    }

    /// Lists the cuts that hold both ends of each link.
    pub(super) fn share_cuts(&mut self) {
        self.shared.clear();
        let start = self.model.terminals.len() as u32;
        for end in self.walk_ends.iter_mut().flatten() {
            let first = self.shared.len() as u32;
            self.shared.extend(self.cuts.shared(start, end.terminal));
            end.shared = (first, self.shared.len() as u32);
        }
        for link in self.links.iter_mut().flatten() {
            let first = self.shared.len() as u32;
            self.shared.extend(self.cuts.shared(link.a, link.b));
            link.shared = (first, self.shared.len() as u32);
        }
    }

    /// What a link pays at each terminal: its multiplier, less those of the cuts that hold it (a link within a cut pays
    /// them back twice, so that only links which leave it profit); and what it pays for joining two runs.
    pub(super) fn weights(&self, multipliers: &Multipliers) -> Weights {
        let cuts = |t: usize| self.cuts.of[t].iter().map(|&cut| multipliers.cuts[cut as usize]).sum::<i64>();
        let nodes = multipliers.nodes.iter().copied().chain([0]);
        let fares = self.directions.as_ref();
        Weights {
            terminals: nodes.enumerate().map(|(t, node)| node - cuts(t)).collect(),
            fares: fares.map(|_| Fares::new(&multipliers.runs, &self.passages, &multipliers.passages)),
        }
    }

    /// The part of the bound that does not depend on the tree: the multipliers times the degrees of a walk.
    fn constant(&self, multipliers: &Multipliers) -> i64 {
        let nodes = |(item, body): (usize, &Body)| match body.closed {
            true => self.dearest(item, multipliers).0,
            false => multipliers.nodes[body.first as usize..body.last as usize].iter().sum(),
        };
        let always = self.cuts.least.iter().zip(&self.cuts.guard).map(|(&least, guard)| match guard {
            None => i64::from(least),
            Some(_) => 0,
        });
        let cuts = multipliers.cuts.iter().zip(always).map(|(cut, least)| cut * least);
        let runs = multipliers.runs.as_flattened().iter();
        let passages = multipliers.passages.iter().sum::<i64>();
        passages + cuts.sum::<i64>()
            - self.model.bodies.iter().enumerate().map(nodes).sum::<i64>()
            - runs.sum::<i64>()
    }

    /// What entering a loop at one piece gives back, where that is most, and at which piece.
    pub(super) fn dearest(&self, item: usize, multipliers: &Multipliers) -> (i64, usize) {
        let body = &self.model.bodies[item];
        let own = &multipliers.nodes[body.first as usize..body.last as usize];
        let ties = |piece: usize| {
            self.blocks[item].iter().map(|&block| multipliers.ties[block as usize + piece]).sum::<i64>()
        };
        let guarded = |piece: usize| {
            let cuts = &self.cuts.guarded[body.first as usize + piece];
            cuts.iter()
                .map(|&cut| multipliers.cuts[cut as usize] * i64::from(self.cuts.least[cut as usize]))
                .sum::<i64>()
        };
        own.iter().enumerate().map(|(k, node)| (2 * node + ties(k) - guarded(k), k)).max().unwrap_or((0, 0))
    }

    /// What the link into or out of the layer pays besides its cost.
    fn pays(&self, side: usize, end: &WalkEnd, weights: &Weights, multipliers: &Multipliers) -> i64 {
        let run = self.run_of(end).zip(weights.fares());
        let run = run.map_or(0, |(run, fares)| fares.at_end(side, run as u32));
        let own = weights.at(end.terminal) + multipliers.ties[end.tie as usize] + run;
        if side == 1 {
            return own;
        }
        let both = self.shared_by(end).iter().map(|&cut| multipliers.cuts[cut as usize]);
        own + weights.at(self.model.terminals.len() as u32) + 2 * both.sum::<i64>()
    }

    /// The run that the walk begins or ends in, if links have directions.
    pub(super) fn run_of(&self, end: &WalkEnd) -> Option<usize> {
        let item = self.model.terminals[end.terminal as usize].item;
        self.directions.as_ref().map(|directions| directions.run_of[item as usize] as usize)
    }

    /// Cuts that hold both the start and the terminal of an end.
    fn shared_by(&self, end: &WalkEnd) -> &[u32] {
        &self.shared[end.shared.0 as usize..end.shared.1 as usize]
    }

    /// The cheapest end: its price and its number.
    fn cheapest(&self, side: usize, weights: &Weights, multipliers: &Multipliers) -> Option<(i64, usize)> {
        let price = |end: &WalkEnd| end.cost + self.pays(side, end, weights, multipliers);
        self.walk_ends[side].iter().map(price).zip(0..).min()
    }

    /// The bound over the known links, and what the solution uses.
    pub(super) fn relax(&mut self, multipliers: &Multipliers, usage: &mut Usage) -> i64 {
        let weights = self.weights(multipliers);
        let start = self.model.terminals.len();
        usage.reset(start + 1, multipliers.cuts.len(), multipliers.ties.len(), multipliers.runs.len());
        let parts = DisjointSets::new(self.model.bodies.len());
        let mut forest = Forest { model: self.model, parts, usage, shared: &self.shared, total: 0 };
        for (depth, links) in self.links.iter_mut().enumerate().rev() {
            let price = |link: &Link| price(link, &weights, multipliers, &self.shared);
            self.keys.clear();
            self.keys.extend(links.iter().map(price).zip(0..));
            match self.directions.as_ref().zip(weights.fares()) {
                Some((directions, fares)) if depth <= RUNS => {
                    forest.span_runs(directions, depth, links, &self.keys, fares);
                }
                _ => forest.span(links, &mut self.keys),
            }
        }
        let mut total = forest.total + self.constant(multipliers);
        for side in 0..2 {
            let Some((price, k)) = self.cheapest(side, &weights, multipliers) else { continue };
            if let Some(run) = self.run_of(&self.walk_ends[side][k]) {
                usage.runs[run][side] += 1;
            }
            let end = &mut self.walk_ends[side][k];
            end.used += 1;
            total += price;
            usage.degrees[end.terminal as usize] += 1;
            usage.tied[end.tie as usize] += 1;
            if side == 0 {
                usage.degrees[start] += 1;
                for &cut in &self.shared[end.shared.0 as usize..end.shared.1 as usize] {
                    usage.inside[cut as usize] += 1;
                }
            }
        }
        total
    }

    /// The bound over all links, which holds whatever the multipliers are, and its tree.
    pub(super) fn exact(&self, multipliers: &Multipliers) -> (i64, Vec<Priced>) {
        let weights = self.weights(multipliers);
        let active = self.cuts.active(&multipliers.cuts);
        let list = |links: &Vec<Link>| {
            let listed = links.iter().map(|link| {
                let [p, q] = [link.a, link.b].map(|t| self.model.terminals[t as usize].first);
                Priced {
                    cost: price(link, &weights, multipliers, &self.shared),
                    from: p.min(q),
                    to: p.max(q),
                }
            });
            listed.collect()
        };
        let prices = Prices {
            listed: self.links.each_ref().map(list),
            known: &|a, b| self.known.contains(&(a.min(b), a.max(b))),
            weights: &weights.terminals,
            both: &|a, b| {
                let cuts = common(&active[a as usize], &active[b as usize]);
                2 * cuts.map(|cut| multipliers.cuts[cut as usize]).sum::<i64>()
                    + self.tied(a, b, multipliers)
                    + self.tied(b, a, multipliers)
            },
        };
        let tree = match self.directions.as_ref().zip(weights.fares()) {
            Some((directions, fares)) => {
                let mut tree = self.pricing.tree(&prices, RUNS + 1);
                tree.extend(directions.span_all(self.model, &prices, fares));
                tree
            }
            None => self.pricing.tree(&prices, 0),
        };
        debug_assert_eq!(tree.len() + 1, self.model.bodies.len().max(1));
        let links: i64 = tree.iter().map(|found| found.cost).sum();
        let ends = (0..2).filter_map(|side| self.cheapest(side, &weights, multipliers));
        let ends: i64 = ends.map(|(price, _)| price).sum();
        (links + ends + self.constant(multipliers), tree)
    }

    /// An exact bound without the links in and out, and the price of links at each point where a walk may begin or
    /// end.
    pub(super) fn settle(&self, bound: i64, multipliers: &Multipliers) -> (i64, [Vec<(Point, i64)>; 2]) {
        let weights = self.weights(multipliers);
        let ends = [0, 1].map(|side| {
            let points = self.walk_ends[side].iter().flat_map(|end| {
                let pay = self.pays(side, end, &weights, multipliers);
                self.model.points_of(end.terminal).iter().map(move |&p| (p, pay))
            });
            points.collect()
        });
        let cheapest = (0..2).filter_map(|side| self.cheapest(side, &weights, multipliers));
        let cheapest: i64 = cheapest.map(|(price, _)| price).sum();
        (bound - cheapest, ends)
    }
}

/// What a program over links asks.
#[cfg(feature = "highs")]
impl Relaxation<'_> {
    /// Makes the links of a solution known.
    pub(super) fn add_order(&mut self, order: &[Visit]) {
        let model = self.model;
        let ends = |visit: &Visit| {
            let at = |entry: u32| model.owner[model.range_of_item(visit.item).start + entry as usize];
            let leave = if model.bodies[visit.item as usize].closed { visit.entry } else { 1 - visit.entry };
            [at(visit.entry), at(leave)]
        };
        for pair in order.windows(2) {
            self.add_link(ends(&pair[0])[1], ends(&pair[1])[0]);
        }
    }

    /// Looks for cuts that a solution violates in which links have shares; how many are new.
    pub(super) fn look_for_used(&mut self, links: &[Vec<f64>; DEPTHS], ends: &[Vec<f64>; 2]) -> usize {
        const TREES: u32 = 1000;
        let used = |share: &f64| (share * f64::from(TREES)) as u32;
        self.forget_trees();
        for (links, shares) in self.links.iter_mut().zip(links) {
            links.iter_mut().zip(shares).for_each(|(link, share)| link.used = used(share));
        }
        for (ends, shares) in self.walk_ends.iter_mut().zip(ends) {
            ends.iter_mut().zip(shares).for_each(|(end, share)| end.used = used(share));
        }
        let before = self.cuts.members.len();
        self.look_for_cuts(TREES);
        self.cuts.members.len() - before
    }

    pub(super) fn is_known(&self, a: u32, b: u32) -> bool {
        self.known.contains(&(a.min(b), a.max(b)))
    }

    /// The piece of each tie, and what links there lead to.
    pub(super) fn neighbours(&self) -> Vec<Option<(u32, Neighbour)>> {
        let mut neighbours = vec![None; self.ties];
        for (&(item, other), &block) in self.block_of.iter().filter(|(_, block)| **block > 0) {
            let body = &self.model.bodies[item as usize];
            for t in body.first..body.last {
                neighbours[tie(block, t - body.first) as usize] = Some((t, Neighbour::Path(other)));
            }
        }
        for (side, ends) in self.walk_ends.iter().enumerate() {
            for end in ends.iter().filter(|end| end.tie > 0) {
                neighbours[end.tie as usize] = Some((end.terminal, Neighbour::Beyond(side)));
            }
        }
        neighbours
    }

    /// The tie of links from a piece to a neighbour, if there are any.
    pub(super) fn tie_of(&self, terminal: u32, neighbour: Neighbour) -> Option<u32> {
        let item = self.model.terminals[terminal as usize].item;
        let first = self.model.bodies[item as usize].first;
        let tie = match neighbour {
            Neighbour::Path(other) => tie(*self.block_of.get(&(item, other))?, terminal - first),
            Neighbour::Beyond(side) => self.walk_ends[side].iter().find(|end| end.terminal == terminal)?.tie,
        };
        Some(tie).filter(|&tie| tie > 0)
    }
}

/// What links at a piece of a loop lead to: another path, or beyond the layer at one side.
#[cfg(feature = "highs")]
#[derive(Clone, Copy)]
pub(super) enum Neighbour {
    Path(u32),
    Beyond(usize),
}

/// The tie of one piece in a block.
fn tie(block: u32, piece: u32) -> u32 {
    if block == 0 { 0 } else { block + piece }
}

/// A listed link's cost and all that it pays.
fn price(link: &Link, weights: &Weights, multipliers: &Multipliers, shared: &[u32]) -> i64 {
    let both: i64 = link.shared(shared).iter().map(|&cut| multipliers.cuts[cut as usize]).sum();
    let ties: i64 = link.ties.iter().map(|&tie| multipliers.ties[tie as usize]).sum();
    link.cost + weights.at(link.a) + weights.at(link.b) + 2 * both + ties
}
