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
    /// Whether a walk may begin its stage with each run.
    begins: Vec<bool>,
    stages: usize,
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
        Some(Self { run_of, begins, stages: model.stages() })
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
        const NONE: i64 = i64::MAX;
        let count = self.count();
        let none = Priced { cost: NONE, from: 0, to: 0 };
        // By head and tail.
        let mut best = vec![none; count * count];
        let mut up = vec![none; self.stages];
        let items: Vec<u32> =
            (0..model.points.len() as u32).map(|point| model.item_of_point(point)).collect();
        let mut improve = |i: u32, j: u32, link: Priced| {
            for (from, to) in [(i, j), (j, i)] {
                let [tail, head] = [from, to].map(|item| self.run_of[item as usize]);
                let [one, other] = [from, to].map(|item| model.bodies[item as usize].groups[0]);
                let (best, link) = match one == other {
                    true => (&mut best[head as usize * count + tail as usize], link),
                    false => {
                        let cost = arc(tail, head, link.cost, fares).price;
                        (&mut up[one as usize], Priced { cost, ..link })
                    }
                };
                if link < *best && model.leads(from, to) {
                    *best = link;
                }
            }
        };
        for &link in prices.listed[..=1].iter().flatten() {
            improve(items[link.from as usize], items[link.to as usize], link);
        }
        for (p, &i) in items.iter().enumerate() {
            for (q, &j) in items.iter().enumerate().skip(p + 1) {
                if self.run_of[i as usize] == self.run_of[j as usize] {
                    continue;
                }
                let [a, b] = [p, q].map(|point| model.owner[point]);
                if !(prices.known)(a, b) && model.permits(i, j) {
                    let cost = model.price(p as u32, q as u32)
                        + prices.weights[a as usize]
                        + prices.weights[b as usize];
                    let cost = cost + (prices.both)(a, b);
                    improve(i, j, Priced { cost, from: p as u32, to: q as u32 });
                }
            }
        }
        let (mut arcs, mut links) = (Vec::new(), Vec::new());
        for (k, &found) in best.iter().enumerate().filter(|(_, found)| found.cost != NONE) {
            let arc = arc((k % count) as u32, (k / count) as u32, found.cost, fares);
            arcs.push(arc);
            links.push(Priced { cost: arc.price, ..found });
        }
        let between = up.into_iter().filter(|link| link.cost != NONE);
        self.solve(&mut arcs).into_iter().map(|arc| links[arc]).chain(between).collect()
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
