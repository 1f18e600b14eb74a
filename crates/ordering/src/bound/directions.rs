//! Which run follows which: under `feature` scope the runs of an island come by rank, so links between runs have a direction.

use super::arborescence::{Arc, cheapest};
use super::link::Link;
use super::model::Model;
use super::passages::Fares;
use super::pricing::{Priced, Prices};

/// The depth of links between runs that may have directions.
pub(super) const RUNS: usize = 1;

/// The price of being where a walk begins, far above all others; it is taken off again.
const BEGIN: i64 = 1 << 50;
/// With more points or runs than these, links have no direction: all pairs are looked at, and contracting takes long.
const MOST_POINTS: usize = 2000;
pub(super) const MOST_RUNS: usize = 300;

/// The runs of a layer whose links have directions.
pub(super) struct Directions {
    /// Run of each path.
    pub(super) run_of: Vec<u32>,
    /// Terminals of each run.
    terminals: Vec<Vec<u32>>,
    /// Whether a walk may begin its stage with each run.
    begins: Vec<bool>,
    stages: usize,
}

/// From one run to another.
struct Way {
    /// What links from stage to stage pay besides.
    fare: i64,
    /// The stage that they leave, if it is another.
    stage: Option<usize>,
    /// The number of the pair of runs, within a stage.
    at: usize,
}

/// The cheapest links so far.
struct Best {
    between: Vec<Priced>,
    up: Vec<Priced>,
}

/// No link.
const NONE: Priced = Priced { cost: i64::MAX, from: 0, to: 0 };

impl Best {
    /// A link that costs more, fares left out, is none of the cheapest.
    fn limit(&self, way: &Way) -> i64 {
        let best = way.stage.map_or(&self.between[way.at], |stage| &self.up[stage]);
        best.cost.saturating_sub(way.fare)
    }

    fn improve(&mut self, way: &Way, link: Priced) {
        let best = way.stage.map_or(&mut self.between[way.at], |stage| &mut self.up[stage]);
        *best = (*best).min(Priced { cost: link.cost + way.fare, ..link });
    }
}

impl Directions {
    /// The directions of a layer's links; `None` where they have none, or are too many.
    pub(super) fn new(model: &Model) -> Option<Self> {
        let run_of = model.run_of();
        let runs = run_of.iter().max().map_or(0, |&last| last as usize + 1);
        let few = model.points.len() <= MOST_POINTS && runs <= MOST_RUNS;
        if !few || model.successions(&run_of).is_empty() {
            return None;
        }
        let mut begins = vec![false; runs];
        (0..).zip(&run_of).for_each(|(item, &run)| begins[run as usize] = model.may_begin_stage(item));
        let mut terminals = vec![Vec::new(); runs];
        for (&run, body) in run_of.iter().zip(&model.bodies) {
            terminals[run as usize].extend(body.first..body.last);
        }
        Some(Self { run_of, terminals, begins, stages: model.stages() })
    }

    /// The arc that a link from an item to another is.
    fn arc(&self, items: [u32; 2], price: i64, fares: &Fares) -> Arc {
        let [tail, head] = items.map(|item| self.run_of[item as usize]);
        arc(tail, head, price, fares)
    }

    pub(super) fn count(&self) -> usize {
        self.begins.len()
    }

    /// The numbers of the cheapest links from each stage to the next, of those given with their prices and numbers, and the arcs that
    /// they are; they pay as in [`Self::span`].
    pub(super) fn climb(
        &self,
        model: &Model,
        links: &[Link],
        keys: &[(i64, u32)],
        fares: &Fares,
    ) -> Vec<(u32, Arc)> {
        let mut best: Vec<Option<(i64, u32, Arc)>> = vec![None; self.stages];
        for &(price, k) in keys {
            let [i, j] = links[k as usize].items(model);
            let [from, to] = if model.leads(i, j) { [i, j] } else { [j, i] };
            let arc = self.arc([from, to], price, fares);
            let best = &mut best[model.bodies[from as usize].groups[0] as usize];
            if best.is_none_or(|best| (arc.price, k) < (best.0, best.1)) {
                *best = Some((arc.price, k, arc));
            }
        }
        best.into_iter().flatten().map(|(_, k, arc)| (k, arc)).collect()
    }

    /// The numbers of the links in a cheapest arborescence over the runs, of those given with their prices and numbers, and the arcs
    /// that they are. Besides, links pay fares.
    pub(super) fn span(
        &self,
        model: &Model,
        links: &[Link],
        keys: &[(i64, u32)],
        fares: &Fares,
    ) -> Vec<(u32, Arc)> {
        let mut arcs = Vec::with_capacity(2 * keys.len() + self.count());
        let mut numbers = Vec::with_capacity(2 * keys.len());
        for &(price, k) in keys {
            let [i, j] = links[k as usize].items(model);
            for (from, to) in [(i, j), (j, i)] {
                if model.leads(from, to) {
                    arcs.push(self.arc([from, to], price, fares));
                    numbers.push(k);
                }
            }
        }
        self.solve(&mut arcs).into_iter().map(|at| (numbers[at], arcs[at])).collect()
    }

    /// A cheapest arborescence over the runs of each stage and the cheapest links between stages, of all links.
    pub(super) fn span_all(&self, model: &Model, prices: &Prices, fares: &Fares) -> Vec<Priced> {
        let count = self.count();
        // By tail and head; those from stage to stage, whose fares count here.
        let mut best = Best { between: vec![NONE; count * count], up: vec![NONE; self.stages] };
        let item = |point: u32| model.item_of_point(point);
        for &link in prices.listed[..=1].iter().flatten() {
            for [from, to] in [[link.from, link.to], [link.to, link.from]].map(|ends| ends.map(item)) {
                if model.leads(from, to) {
                    best.improve(&self.way(model, [from, to], fares), link);
                }
            }
        }
        for (one, other) in (0..count).flat_map(|one| (one + 1..count).map(move |other| (one, other))) {
            let [one, other] = [one, other].map(|run| &self.terminals[run]);
            let first = [one, other].map(|terminals| model.terminals[terminals[0] as usize].item);
            // What precedence says of two paths, it says of their runs.
            let ways = [first, [first[1], first[0]]]
                .map(|[from, to]| Some(self.way(model, [from, to], fares)).filter(|_| model.leads(from, to)));
            if ways.iter().all(Option::is_none) {
                continue;
            }
            for (&a, &b) in one.iter().flat_map(|a| other.iter().map(move |b| (a, b))) {
                let (p, q) = model.nearest(a, b);
                let cost = model.price(p, q) + prices.weights[a as usize] + prices.weights[b as usize];
                let enough = |way: &Way| cost <= best.limit(way);
                if !ways.iter().flatten().any(enough) || (prices.known)(a, b) {
                    continue;
                }
                let cost = cost + (prices.both)(a, b);
                let link = Priced { cost, from: p.min(q), to: p.max(q) };
                ways.iter().flatten().for_each(|way| best.improve(way, link));
            }
        }
        let (mut arcs, mut links) = (Vec::new(), Vec::new());
        for (k, &found) in best.between.iter().enumerate().filter(|(_, found)| found.cost != NONE.cost) {
            let arc = arc((k / count) as u32, (k % count) as u32, found.cost, fares);
            arcs.push(arc);
            links.push(Priced { cost: arc.price, ..found });
        }
        let between = best.up.into_iter().filter(|link| link.cost != NONE.cost);
        self.solve(&mut arcs).into_iter().map(|arc| links[arc]).chain(between).collect()
    }

    fn way(&self, model: &Model, items: [u32; 2], fares: &Fares) -> Way {
        let [tail, head] = items.map(|item| self.run_of[item as usize]);
        let [one, other] = items.map(|item| model.bodies[item as usize].groups[0]);
        match one == other {
            true => Way { fare: 0, stage: None, at: tail as usize * self.count() + head as usize },
            false => Way { fare: fares.of(tail, head), stage: Some(one as usize), at: 0 },
        }
    }

    /// The numbers of the arcs in a cheapest arborescence of each stage that begins with any run which may come first.
    fn solve(&self, arcs: &mut Vec<Arc>) -> Vec<usize> {
        let (count, links) = (self.count(), arcs.len());
        let begins = (0..count as u32).filter(|&run| self.begins[run as usize]);
        arcs.extend(begins.map(|run| Arc { price: BEGIN, tail: count as u32, head: run }));
        let entered = cheapest(count + 1, arcs).unwrap_or_default();
        let used: Vec<usize> =
            entered.into_iter().map(|arc| arc as usize).filter(|&arc| arc < links).collect();
        // Links that lead everywhere are known from the beginning.
        debug_assert_eq!(used.len() + self.stages, count);
        used
    }
}

/// The arc of a link from one run to another.
fn arc(tail: u32, head: u32, price: i64, fares: &Fares) -> Arc {
    Arc { price: price + fares.of(tail, head), tail, head }
}
