//! Held and Karp's ascent over a sparse set of links, which pricing completes.

use rustc_hash::FxHashSet;

use super::super::christofides::Parts;
use super::super::matching::delaunay;
use super::model::{DEPTHS, Model, link};
use super::pricing::{Priced, Pricing};
use crate::geom::Point;

/// Where a walk may begin or end, and what the link there costs.
pub(super) type Way = Vec<(u32, i64)>;

#[derive(Clone, Copy)]
struct Link {
    cost: i64,
    a: u32,
    b: u32,
}

/// A spanning tree in the making.
struct Forest<'a> {
    model: &'a Model,
    parts: Parts,
    degrees: &'a mut [i32],
    total: i64,
}

impl Forest<'_> {
    /// Joins what the links can join, cheapest first: Kruskal, with quicksort's halves sorted only when their turn
    /// comes and rid of links that have become idle (Osipov, Sanders & Singler 2009, <https://doi.org/10.1137/1.9781611972894.5>).
    fn span(&mut self, links: &[Link], keys: &mut [(i64, u32)]) {
        const SMALL: usize = 64;
        if keys.len() <= SMALL {
            keys.sort_unstable();
            for &(cost, k) in &*keys {
                let Link { a, b, .. } = links[k as usize];
                if self.parts.join(self.item(a), self.item(b)) {
                    self.total += cost;
                    self.degrees[a as usize] += 1;
                    self.degrees[b as usize] += 1;
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
            entry: terminals(&|item| model.may_begin(item)),
            exit: terminals(&|item| model.may_end(item)),
            keys: Vec::new(),
            run_of: model.run_of(),
        };
        relaxation.add_neighbours();
        let zero = vec![0; model.terminals.len()];
        for found in relaxation.pricing.tree(&zero) {
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

    /// Makes all links between two paths known.
    fn add_pair(&mut self, i: u32, j: u32) -> bool {
        let model = self.model;
        let (i, j) = (i.min(j), i.max(j));
        if i == j || !model.permits(i, j) || !self.known.insert((i, j)) {
            return false;
        }
        let (one, other) = (&model.bodies[i as usize], &model.bodies[j as usize]);
        let depth = model.depth(i, j);
        for a in one.first..one.last {
            for b in other.first..other.last {
                let nearest = model
                    .points_of(a)
                    .iter()
                    .flat_map(|&p| model.points_of(b).iter().map(move |&q| p.distance2(q)))
                    .min()
                    .unwrap_or(0);
                let cost = super::model::fine((nearest as f64).sqrt()).max(0);
                self.links[depth].push(Link { cost, a, b });
            }
        }
        true
    }

    /// Terms of the bound that do not depend on the tree.
    fn constant(&self, weights: &[i64]) -> i64 {
        self.model
            .bodies
            .iter()
            .map(|body| {
                let own = &weights[body.first as usize..body.last as usize];
                if body.closed { 2 * own.iter().copied().max().unwrap_or(0) } else { own.iter().sum() }
            })
            .sum()
    }

    fn cheapest(way: &Way, weights: &[i64]) -> (i64, u32) {
        way.iter().map(|&(terminal, cost)| (cost + weights[terminal as usize], terminal)).min().unwrap_or((0, u32::MAX))
    }

    /// The bound on the known links, and how many links each terminal has in the cheapest tree.
    fn relax(&mut self, weights: &[i64], degrees: &mut [i32]) -> i64 {
        let mut forest = Forest { model: self.model, parts: Parts::new(self.model.bodies.len()), degrees, total: 0 };
        forest.degrees.fill(0);
        for links in self.links.iter().rev() {
            self.keys.clear();
            self.keys.extend(
                links.iter().zip(0..).map(|(l, k)| (l.cost + weights[l.a as usize] + weights[l.b as usize], k)),
            );
            forest.span(links, &mut self.keys);
        }
        let Forest { mut total, degrees, .. } = forest;
        for way in [&self.entry, &self.exit] {
            let (cost, terminal) = Self::cheapest(way, weights);
            if terminal != u32::MAX {
                total += cost;
                degrees[terminal as usize] += 1;
            }
        }
        total - self.constant(weights)
    }

    /// The bound over all links: what is published. Also tells the tree.
    fn exact(&self, weights: &[i64]) -> (i64, Vec<Priced>) {
        let tree = self.pricing.tree(weights);
        let links: i64 = tree.iter().map(|found| found.cost).sum();
        let ways: i64 = [&self.entry, &self.exit].iter().map(|way| Self::cheapest(way, weights).0).sum();
        (links + ways - self.constant(weights), tree)
    }

    /// Multipliers per terminal and the bound they prove.
    pub(super) fn ascend(&mut self) -> (i64, Vec<i64>) {
        let model = self.model;
        let n = model.terminals.len();
        let mut degrees = vec![0; n];
        let iters: usize = std::env::var("ITERS").map_or(150, |v| v.parse().unwrap());
        let first: f64 = std::env::var("STEP").map_or(1.0, |v| v.parse().unwrap());
        let last_step: f64 = std::env::var("LAST").map_or(0.01, |v| v.parse().unwrap());
        let shift: f64 = std::env::var("SHIFT").map_or(0.5, |v| v.parse().unwrap());
        let decay = last_step.powf(1.0 / iters as f64);
        let mut weights = vec![0.0; n];
        let mut rounded = vec![0; n];
        let (value, _) = self.exact(&rounded);
        let mut best = (value, rounded.clone());
        let mut top = (i64::MIN, rounded.clone());
        let mut last: Vec<f64> = vec![0.0; n];
        let mut direction: Vec<f64> = vec![0.0; n];
        let mut step = first * value.max(n as i64) as f64 / n as f64;
        self.relax(&rounded, &mut degrees);
        let mut next_check = 8;
        let mut runs: Vec<f64> = vec![0.0; model.bodies.len()];
        for i in 1..=iters {
            runs.fill(0.0);
            for (body, k) in model.bodies.iter().zip(0..) {
                let own = body.first as usize..body.last as usize;
                let target = if body.closed { 2 } else { 1 };
                for t in own {
                    direction[t] = f64::from(degrees[t] - target);
                    runs[self.run_of[k] as usize] += direction[t];
                }
            }
            for (t, terminal) in model.terminals.iter().enumerate() {
                let d = direction[t] + shift * runs[self.run_of[terminal.item as usize] as usize];
                weights[t] += step * (0.7 * d + 0.3 * last[t]);
                last[t] = d;
                rounded[t] = weights[t].round() as i64;
            }
            step *= decay;
            let mut value = self.relax(&rounded, &mut degrees);
            if i == next_check || i == iters {
                next_check = next_check * 3 / 2;
                let (exact, tree) = self.exact(if i == iters { &top.1 } else { &rounded });
                if exact > best.0 {
                    best = (exact, if i == iters { top.1.clone() } else { rounded.clone() });
                }
                if std::env::var("DBG").is_ok() { eprintln!("{i} top {} value {value} exact {}", top.0, exact); }
                let mut grown = false;
                for found in tree {
                    grown |= self.add_pair(model.item_of_point(found.from), model.item_of_point(found.to));
                }
                if grown {
                    value = self.relax(&rounded, &mut degrees);
                    top = best.clone();
                }
            }
            if value > top.0 {
                top = (value, rounded.clone());
            }
        }
        best
    }

    /// Makes the link from a known place part of the bound.
    pub(super) fn start_from(&mut self, place: Point) {
        for (terminal, cost) in &mut self.entry {
            *cost = nearest(self.model.points_of(*terminal), place);
        }
    }

    /// Makes the link to a known place part of the bound.
    pub(super) fn end_at(&mut self, place: Point) {
        for (terminal, cost) in &mut self.exit {
            *cost = nearest(self.model.points_of(*terminal), place);
        }
    }
}

fn nearest(points: &[Point], place: Point) -> i64 {
    points.iter().map(|&p| link(p, place)).min().unwrap_or(0)
}
