//! Held and Karp's ascent over a sparse set of links, which pricing completes.

use rustc_hash::FxHashSet;

use super::super::christofides::Parts;
use super::super::matching::delaunay;
use super::model::{Body, DEPTHS, Model};
use super::pricing::{Priced, Pricing};
use crate::geom::Point;

/// Where a walk may begin or end, and what the link there costs.
pub(super) type Way = Vec<(u32, i64)>;

#[derive(Clone, Copy)]
struct Link {
    cost: i64,
    a: u32,
    b: u32,
    /// Cuts that hold both ends: a piece of the list of all these.
    shared: (u32, u32),
    /// Trees since the last look that used it.
    used: u32,
    /// Ties of its ends; 0: none.
    ties: [u32; 2],
}

/// Sets of terminals that an odd number of links must leave.
#[derive(Default)]
pub(super) struct Cuts {
    members: Vec<Vec<u32>>,
    known: FxHashSet<Vec<u32>>,
    /// Cuts of each terminal, ascending.
    of: Vec<Vec<u32>>,
}

impl Cuts {
    /// Cuts that hold both terminals.
    pub(super) fn shared(&self, a: u32, b: u32) -> impl Iterator<Item = u32> {
        let other = &self.of[b as usize];
        self.of[a as usize].iter().copied().filter(move |cut| other.binary_search(cut).is_ok())
    }

    fn add(&mut self, members: Vec<u32>) -> bool {
        if !self.known.insert(members.clone()) {
            return false;
        }
        for &t in &members {
            self.of[t as usize].push(self.members.len() as u32);
        }
        self.members.push(members);
        true
    }
}

/// One multiplier for each terminal's number of links, and one for each cut.
#[derive(Clone)]
pub(super) struct Multipliers {
    nodes: Vec<i64>,
    cuts: Vec<i64>,
    ties: Vec<i64>,
}

impl Multipliers {
    /// What a link pays at each of its ends: the terminal's multiplier, less those of the cuts that hold it.
    fn weights(&self, cuts: &Cuts) -> Vec<i64> {
        let at = |t: usize| self.nodes[t] - cuts.of[t].iter().map(|&cut| self.cuts[cut as usize]).sum::<i64>();
        (0..self.nodes.len()).map(at).collect()
    }
}

/// A spanning tree in the making.
struct Forest<'a> {
    model: &'a Model,
    parts: Parts,
    degrees: &'a mut [i32],
    inside: &'a mut [i32],
    tied: &'a mut [i32],
    shared: &'a [u32],
    total: i64,
}

impl Forest<'_> {
    /// Joins what the links can join, cheapest first: Kruskal, with quicksort's halves sorted only when their turn
    /// comes and rid of links that have become idle (Osipov, Sanders & Singler 2009, <https://doi.org/10.1137/1.9781611972894.5>).
    fn span(&mut self, links: &mut [Link], keys: &mut [(i64, u32)]) {
        const SMALL: usize = 64;
        if keys.len() <= SMALL {
            keys.sort_unstable();
            for &(cost, k) in &*keys {
                let Link { a, b, .. } = links[k as usize];
                if self.parts.join(self.item(a), self.item(b)) {
                    self.total += cost;
                    self.degrees[a as usize] += 1;
                    self.degrees[b as usize] += 1;
                    let link = &mut links[k as usize];
                    link.used += 1;
                    for tie in link.ties {
                        self.tied[tie as usize] += 1;
                    }
                    for &cut in &self.shared[link.shared.0 as usize..link.shared.1 as usize] {
                        self.inside[cut as usize] += 1;
                    }
                }
            }
            return;
        }
        let (light, middle, heavy) = keys.select_nth_unstable(keys.len() / 4);
        let middle = *middle;
        self.span(links, light);
        self.span(links, &mut [middle]);
        let mut kept = 0;
        for at in 0..heavy.len() {
            let Link { a, b, .. } = links[heavy[at].1 as usize];
            if self.parts.find(self.item(a)) != self.parts.find(self.item(b)) {
                heavy.swap(kept, at);
                kept += 1;
            }
        }
        self.span(links, &mut heavy[..kept]);
    }

    fn item(&self, terminal: u32) -> u32 {
        self.model.terminals[terminal as usize].item
    }
}

/// The relaxation of one layer.
pub(super) struct Relaxation<'a> {
    pub(super) model: &'a Model,
    pricing: Pricing<'a>,
    links: [Vec<Link>; DEPTHS],
    known: FxHashSet<(u32, u32)>,
    cuts: Cuts,
    shared: Vec<u32>,
    /// First tie of each block of each loop: one block for each neighbour.
    blocks: Vec<Vec<u32>>,
    ties: u32,
    way_ties: [Vec<u32>; 2],
    pub(super) entry: Way,
    pub(super) exit: Way,
    keys: Vec<(i64, u32)>,
    run_of: Vec<u32>,
}

impl<'a> Relaxation<'a> {
    pub(super) fn new(model: &'a Model) -> Self {
        let pricing = Pricing::new(model);
        let items = 0..model.bodies.len() as u32;
        let terminals = |permitted: &dyn Fn(u32) -> bool| {
            items
                .clone()
                .filter(|&item| permitted(item))
                .flat_map(|item| model.bodies[item as usize].first..model.bodies[item as usize].last)
                .map(|terminal| (terminal, 0))
                .collect()
        };
        let mut relaxation = Self {
            model,
            pricing,
            links: Default::default(),
            known: FxHashSet::default(),
            cuts: Cuts { of: vec![Vec::new(); model.terminals.len()], ..Cuts::default() },
            shared: Vec::new(),
            blocks: vec![Vec::new(); model.bodies.len()],
            ties: 1,
            way_ties: Default::default(),
            entry: terminals(&|item| model.may_begin(item)),
            exit: terminals(&|item| model.may_end(item)),
            keys: Vec::new(),
            run_of: model.run_of(),
        };
        relaxation.add_neighbours();
        for way in 0..2 {
            let listed: Vec<u32> = [&relaxation.entry, &relaxation.exit][way].iter().map(|&(t, _)| t).collect();
            for t in listed {
                let item = model.terminals[t as usize].item;
                let body = &model.bodies[item as usize];
                if t == body.first {
                    let block = relaxation.add_block(item);
                    relaxation.way_ties[way].extend((body.first..body.last).map(|t| if block == 0 { 0 } else { block + t - body.first }));
                }
            }
        }
        let zero = Multipliers { nodes: vec![0; model.terminals.len()], cuts: Vec::new(), ties: vec![0; relaxation.ties as usize] };
        for found in relaxation.exact(&zero).1 {
            relaxation.add_pair(model.item_of_point(found.from), model.item_of_point(found.to));
        }
        relaxation
    }

    /// Pairs of paths that a Delaunay edge joins.
    fn add_neighbours(&mut self) {
        let model = self.model;
        let mut pairs = Vec::new();
        for points in self.pricing.families() {
            let places: Vec<Point> = points.iter().map(|&point| model.points[point as usize]).collect();
            let item = |k: u32| model.item_of_point(points[k as usize]);
            pairs.extend(delaunay(&places).into_iter().map(|(u, v)| (item(u), item(v))));
        }
        for (i, j) in pairs {
            self.add_pair(i, j);
        }
    }

    /// Ties for the links from one neighbour to each piece of a loop; 0 for other paths.
    fn add_block(&mut self, item: u32) -> u32 {
        let body = &self.model.bodies[item as usize];
        if !body.closed || body.last - body.first < 2 {
            return 0;
        }
        let block = self.ties;
        self.ties += body.last - body.first;
        self.blocks[item as usize].push(block);
        block
    }

    /// Makes all links between two paths known.
    fn add_pair(&mut self, i: u32, j: u32) -> bool {
        let model = self.model;
        let (i, j) = (i.min(j), i.max(j));
        if i == j || !model.permits(i, j) || !self.known.insert((i, j)) {
            return false;
        }
        let (one, other) = (&model.bodies[i as usize], &model.bodies[j as usize]);
        let depth = model.depth(i, j);
        let blocks = [self.add_block(i), self.add_block(j)];
        for a in one.first..one.last {
            for b in other.first..other.last {
                let nearest = model
                    .points_of(a)
                    .iter()
                    .flat_map(|&p| model.points_of(b).iter().map(move |&q| p.distance2(q)))
                    .min()
                    .unwrap_or(0);
                let cost = super::model::fine((nearest as f64).sqrt()).max(0);
                let first = self.shared.len() as u32;
                self.shared.extend(self.cuts.shared(a, b));
                let shared = (first, self.shared.len() as u32);
                let tie = |block: u32, piece: u32| if block == 0 { 0 } else { block + piece };
                let ties = [tie(blocks[0], a - one.first), tie(blocks[1], b - other.first)];
                self.links[depth].push(Link { cost, a, b, shared, used: 0, ties });
            }
        }
        true
    }

    /// Terms of the bound that do not depend on the tree.
    fn constant(&self, multipliers: &Multipliers) -> i64 {
        let nodes = |(body, blocks): (&Body, &Vec<u32>)| {
            let own = &multipliers.nodes[body.first as usize..body.last as usize];
            if body.closed { Self::dearest(own, blocks, multipliers).0 } else { own.iter().sum() }
        };
        multipliers.cuts.iter().sum::<i64>() - self.model.bodies.iter().zip(&self.blocks).map(nodes).sum::<i64>()
    }

    /// What the multipliers pay for entering a loop at the piece for which that is most, and which piece.
    fn dearest(own: &[i64], blocks: &[u32], multipliers: &Multipliers) -> (i64, usize) {
        let pay = |piece: usize| {
            2 * own[piece] + blocks.iter().map(|&block| multipliers.ties[block as usize + piece]).sum::<i64>()
        };
        (0..own.len()).map(|piece| (pay(piece), piece)).max().unwrap_or((0, 0))
    }

    /// The cheapest way in or out: its cost, the terminal, and the tie.
    fn cheapest(&self, which: usize, weights: &[i64], ties: &[i64]) -> (i64, u32, u32) {
        let way = [&self.entry, &self.exit][which];
        way.iter()
            .zip(&self.way_ties[which])
            .map(|(&(t, cost), &tie)| (cost + weights[t as usize] + ties[tie as usize], t, tie))
            .min()
            .unwrap_or((0, u32::MAX, 0))
    }

    /// The bound on the known links, how many links each terminal has in the cheapest tree, and how many lie within each cut.
    fn relax(&mut self, multipliers: &Multipliers, degrees: &mut [i32], inside: &mut Vec<i32>, tied: &mut Vec<i32>) -> i64 {
        let weights = multipliers.weights(&self.cuts);
        inside.clear();
        inside.resize(multipliers.cuts.len(), 0);
        tied.clear();
        tied.resize(multipliers.ties.len(), 0);
        degrees.fill(0);
        let parts = Parts::new(self.model.bodies.len());
        let mut forest = Forest { model: self.model, parts, degrees, inside, tied, shared: &self.shared, total: 0 };
        for links in self.links.iter_mut().rev() {
            let key = |link: &Link| {
                let shared = &self.shared[link.shared.0 as usize..link.shared.1 as usize];
                let both: i64 = shared.iter().map(|&cut| multipliers.cuts[cut as usize]).sum();
                link.cost + weights[link.a as usize] + weights[link.b as usize] + 2 * both + multipliers.ties[link.ties[0] as usize] + multipliers.ties[link.ties[1] as usize]
            };
            self.keys.clear();
            self.keys.extend(links.iter().map(key).zip(0..));
            forest.span(links, &mut self.keys);
        }
        let mut total = forest.total;
        for way in 0..2 {
            let (cost, terminal, tie) = self.cheapest(way, &weights, &multipliers.ties);
            if terminal != u32::MAX {
                total += cost;
                degrees[terminal as usize] += 1;
                tied[tie as usize] += 1;
            }
        }
        total + self.constant(multipliers)
    }

    /// The bound over all links: what is published. Also tells the tree.
    fn exact(&self, multipliers: &Multipliers) -> (i64, Vec<Priced>) {
        let weights = multipliers.weights(&self.cuts);
        let both = |a: u32, b: u32| 2 * self.cuts.shared(a, b).map(|cut| multipliers.cuts[cut as usize]).sum::<i64>();
        let mut listed: [Vec<Priced>; DEPTHS] = Default::default();
        for (listed, links) in listed.iter_mut().zip(&self.links) {
            listed.extend(links.iter().map(|link| {
                let [p, q] = [link.a, link.b].map(|t| self.model.terminals[t as usize].first);
                let ties = multipliers.ties[link.ties[0] as usize] + multipliers.ties[link.ties[1] as usize];
                let cost = link.cost + weights[link.a as usize] + weights[link.b as usize] + both(link.a, link.b) + ties;
                Priced { cost, from: p.min(q), to: p.max(q) }
            }));
        }
        let known = |i: u32, j: u32| self.known.contains(&(i.min(j), i.max(j)));
        let tree = self.pricing.tree(&weights, &both, &listed, &known);
        let links: i64 = tree.iter().map(|found| found.cost).sum();
        let ways: i64 = (0..2).map(|way| self.cheapest(way, &weights, &multipliers.ties).0).sum();
        (links + ways + self.constant(multipliers), tree)
    }

    /// Looks for odd sets that recent trees left less than once on average: parts that are joined by links used in
    /// more than a share of the trees.
    fn separate(&mut self, trees: u32) -> bool {
        let model = self.model;
        let mut grown = false;
        for share in [0.0, 0.15, 0.3, 0.45, 0.6] {
            let mut parts = Parts::new(model.terminals.len());
            // At which of its pieces a loop is entered is open: a cut holds all of them or none.
            for body in &model.bodies {
                if body.closed { (body.first + 1..body.last).for_each(|t| { parts.join(body.first, t); }); }
            }
            let mut leaving = vec![0; model.terminals.len()];
            for link in self.links.iter().flatten() {
                if f64::from(link.used) > share * f64::from(trees) {
                    parts.join(link.a, link.b);
                }
            }
            for link in self.links.iter().flatten() {
                let (a, b) = (parts.find(link.a), parts.find(link.b));
                if a != b {
                    leaving[a as usize] += link.used;
                    leaving[b as usize] += link.used;
                }
            }
            let mut members = vec![Vec::new(); model.terminals.len()];
            for t in 0..model.terminals.len() as u32 {
                members[parts.find(t) as usize].push(t);
            }
            for (part, members) in members.into_iter().enumerate() {
                let open = |t: &&u32| !model.bodies[model.terminals[**t as usize].item as usize].closed;
                if members.len() > 2
                    && members.iter().filter(open).count() % 2 == 1
                    && f64::from(leaving[part]) < 0.95 * f64::from(trees)
                {
                    grown |= self.cuts.add(members);
                }
            }
        }
        if grown {
            self.shared.clear();
            for link in self.links.iter_mut().flatten() {
                let first = self.shared.len() as u32;
                self.shared.extend(self.cuts.shared(link.a, link.b));
                link.shared = (first, self.shared.len() as u32);
            }
        }
        grown
    }

    /// Multipliers and the bound they prove.
    pub(super) fn ascend(&mut self) -> (i64, Multipliers) {
        let model = self.model;
        let n = model.terminals.len();
        let mut degrees = vec![0; n];
        let iters: usize = std::env::var("ITERS").map_or(150, |v| v.parse().unwrap());
        let first: f64 = std::env::var("STEP").map_or(1.0, |v| v.parse().unwrap());
        let last_step: f64 = std::env::var("LAST").map_or(0.01, |v| v.parse().unwrap());
        let shift: f64 = std::env::var("SHIFT").map_or(0.5, |v| v.parse().unwrap());
        let cut_from: usize = std::env::var("CUTS").map_or(20, |v| v.parse().unwrap());
        let decay = last_step.powf(1.0 / iters as f64);
        let mut weights = vec![0.0; n];
        let mut cut_weights: Vec<f64> = Vec::new();
        let mut cut_last: Vec<f64> = Vec::new();
        let mut tie_weights: Vec<f64> = vec![0.0; self.ties as usize];
        let mut tie_last: Vec<f64> = vec![0.0; self.ties as usize];
        let mut tied = Vec::new();
        let mut rounded = Multipliers { nodes: vec![0; n], cuts: Vec::new(), ties: vec![0; self.ties as usize] };
        let (value, _) = self.exact(&rounded);
        let mut best = (value, rounded.clone());
        let mut top = (i64::MIN, rounded.clone());
        let mut last: Vec<f64> = vec![0.0; n];
        let mut direction: Vec<f64> = vec![0.0; n];
        let mut step = first * value.max(n as i64) as f64 / n as f64;
        let mut inside = Vec::new();
        self.relax(&rounded, &mut degrees, &mut inside, &mut tied);
        let (mut next_check, mut last_check) = (8, 0);
        let mut runs: Vec<f64> = vec![0.0; model.bodies.len()];
        for i in 1..=iters {
            runs.fill(0.0);
            for (body, k) in model.bodies.iter().zip(0..) {
                let own = body.first as usize..body.last as usize;
                let blocks = &self.blocks[k];
                let (_, entered) = if body.closed { Self::dearest(&rounded.nodes[own.clone()], blocks, &rounded) } else { (0, 0) };
                for (piece, t) in own.enumerate() {
                    let target = if body.closed { 2 * i32::from(piece == entered) } else { 1 };
                    direction[t] = f64::from(degrees[t] - target);
                    runs[self.run_of[k] as usize] += direction[t];
                    for &block in blocks {
                        let tie = block as usize + piece;
                        let d = f64::from(tied[tie] - i32::from(piece == entered));
                        tie_weights[tie] = (tie_weights[tie] + step * (0.7 * d + 0.3 * tie_last[tie])).max(0.0);
                        tie_last[tie] = d;
                    }
                }
            }
            for (rounded, weight) in rounded.ties.iter_mut().zip(&tie_weights) { *rounded = weight.round() as i64; }
            for (t, terminal) in model.terminals.iter().enumerate() {
                let d = direction[t] + shift * runs[self.run_of[terminal.item as usize] as usize];
                weights[t] += step * (0.7 * d + 0.3 * last[t]);
                last[t] = d;
                rounded.nodes[t] = weights[t].round() as i64;
            }
            for (cut, members) in self.cuts.members.iter().enumerate() {
                let leaving = members.iter().map(|&t| degrees[t as usize]).sum::<i32>() - 2 * inside[cut];
                let d = f64::from(1 - leaving);
                cut_weights[cut] = (cut_weights[cut] + step * (0.7 * d + 0.3 * cut_last[cut])).max(0.0);
                cut_last[cut] = d;
                rounded.cuts[cut] = cut_weights[cut].round() as i64;
            }
            step *= decay;
            let mut value = self.relax(&rounded, &mut degrees, &mut inside, &mut tied);
            if i == next_check || i == iters {
                next_check = next_check * 3 / 2;
                let (exact, tree) = self.exact(if i == iters { &top.1 } else { &rounded });
                if exact > best.0 {
                    best = (exact, if i == iters { top.1.clone() } else { rounded.clone() });
                }
                if std::env::var("DBG").is_ok() { eprintln!("{i} top {} value {value} exact {} cuts {}", top.0, exact, self.cuts.members.len()); }
                let mut grown = false;
                for found in tree {
                    grown |= self.add_pair(model.item_of_point(found.from), model.item_of_point(found.to));
                }
                if tie_weights.len() < self.ties as usize {
                    let ties = self.ties as usize;
                    for m in [&mut rounded, &mut best.1, &mut top.1] { m.ties.resize(ties, 0); }
                    tie_weights.resize(ties, 0.0);
                    tie_last.resize(ties, 0.0);
                }
                if i >= cut_from && i < iters && self.separate((i - last_check) as u32) {
                    grown = true;
                    let cuts = self.cuts.members.len();
                    for m in [&mut rounded, &mut best.1, &mut top.1] { m.cuts.resize(cuts, 0); }
                    cut_weights.resize(cuts, 0.0);
                    cut_last.resize(cuts, 0.0);
                }
                last_check = i;
                self.links.iter_mut().flatten().for_each(|link| link.used = 0);
                if grown {
                    value = self.relax(&rounded, &mut degrees, &mut inside, &mut tied);
                    top = best.clone();
                }
            }
            if value > top.0 {
                top = (value, rounded.clone());
            }
        }
        let cuts = self.cuts.members.len();
        best.1.cuts.resize(cuts, 0);
        best.1.ties.resize(self.ties as usize, 0);
        best
    }

    /// Makes the link from where a walk comes from part of the bound; `cost` is the least to arrive at a point.
    pub(super) fn arrive(&mut self, cost: impl Fn(Point) -> i64) {
        price(self.model, &mut self.entry, cost);
    }

    /// Makes the link to where a walk goes on part of the bound.
    pub(super) fn leave(&mut self, cost: impl Fn(Point) -> i64) {
        price(self.model, &mut self.exit, cost);
    }

    /// Under the final multipliers: the bound without the way out, and what a link pays at each point where a walk may
    /// end.
    pub(super) fn settle(&self, multipliers: &Multipliers) -> (i64, Vec<(Point, i64)>) {
        let weights = multipliers.weights(&self.cuts);
        let total = self.exact(multipliers).0 - self.cheapest(1, &weights, &multipliers.ties).0;
        let ends = self.exit.iter().zip(&self.way_ties[1]).flat_map(|(&(terminal, _), &tie)| {
            let pay = weights[terminal as usize] + multipliers.ties[tie as usize];
            self.model.points_of(terminal).iter().map(move |&p| (p, pay))
        });
        (total, ends.collect())
    }
}

fn price(model: &Model, way: &mut Way, cost: impl Fn(Point) -> i64) {
    for (terminal, price) in way {
        *price = model.points_of(*terminal).iter().map(|&p| cost(p)).min().unwrap_or(0);
    }
}
