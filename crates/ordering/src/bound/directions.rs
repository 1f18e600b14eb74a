//! Which run follows which: under `feature` scope the runs of an island come by rank, so links between runs have a direction.

use super::arborescence::{Arc, cheapest};
use super::link::Link;
use super::model::Model;
use super::pricing::{Priced, Prices};

/// The price of being where a walk begins, far above all others; it is taken off again.
const BEGIN: i64 = 1 << 50;
/// With more points or runs than these, links have no direction: all pairs are looked at, and contracting takes long.
const MOST_POINTS: usize = 2000;
const MOST_RUNS: usize = 300;

/// The runs of a layer of one stage whose links have directions.
pub(super) struct Directions {
    /// Run of each path.
    pub(super) run_of: Vec<u32>,
    /// Whether a walk may begin with each run.
    begins: Vec<bool>,
}

impl Directions {
    /// The directions of a layer's links; `None` where they have none, or are too many.
    pub(super) fn new(model: &Model) -> Option<Self> {
        let run_of = model.run_of();
        let runs = run_of.iter().max().map_or(0, |&last| last as usize + 1);
        let few = model.points.len() <= MOST_POINTS && runs <= MOST_RUNS;
        if !few || !model.is_one_stage() || model.successions(&run_of).is_empty() {
            return None;
        }
        let mut begins = vec![false; runs];
        (0..).zip(&run_of).for_each(|(item, &run)| begins[run as usize] = model.may_begin(item));
        Some(Self { run_of, begins })
    }

    pub(super) fn count(&self) -> usize {
        self.begins.len()
    }

    /// The numbers of the links in a cheapest arborescence over the runs, of those given with their prices and numbers, and the arcs
    /// that they are. Besides, a link pays `runs[i][1]` for leaving run i, and `runs[i][0]` for entering it.
    pub(super) fn span(
        &self,
        model: &Model,
        links: &[Link],
        keys: &[(i64, u32)],
        runs: &[[i64; 2]],
    ) -> Vec<(u32, Arc)> {
        let mut arcs = Vec::with_capacity(2 * keys.len() + self.count());
        let mut numbers = Vec::with_capacity(2 * keys.len());
        for &(price, k) in keys {
            let Link { a, b, .. } = links[k as usize];
            let [i, j] = [a, b].map(|t| model.terminals[t as usize].item);
            for (from, to) in [(i, j), (j, i)] {
                if model.leads(from, to) {
                    let [tail, head] = [from, to].map(|item| self.run_of[item as usize]);
                    arcs.push(arc(tail, head, price, runs));
                    numbers.push(k);
                }
            }
        }
        self.solve(&mut arcs).into_iter().map(|at| (numbers[at], arcs[at])).collect()
    }

    /// A cheapest arborescence over the runs, of all links.
    pub(super) fn span_all(&self, model: &Model, prices: &Prices, runs: &[[i64; 2]]) -> Vec<Priced> {
        const NONE: i64 = i64::MAX;
        let count = self.count();
        // By head and tail.
        let mut best = vec![Priced { cost: NONE, from: 0, to: 0 }; count * count];
        let items: Vec<u32> =
            (0..model.points.len() as u32).map(|point| model.item_of_point(point)).collect();
        let mut improve = |i: u32, j: u32, link: Priced| {
            for (from, to) in [(i, j), (j, i)] {
                let [tail, head] = [from, to].map(|item| self.run_of[item as usize] as usize);
                let best = &mut best[head * count + tail];
                if link < *best && model.leads(from, to) {
                    *best = link;
                }
            }
        };
        for &link in &prices.listed[1] {
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
            let arc = arc((k % count) as u32, (k / count) as u32, found.cost, runs);
            arcs.push(arc);
            links.push(Priced { cost: arc.price, ..found });
        }
        self.solve(&mut arcs).into_iter().map(|arc| links[arc]).collect()
    }

    /// The numbers of the arcs in a cheapest arborescence that begins with any run which may come first.
    fn solve(&self, arcs: &mut Vec<Arc>) -> Vec<usize> {
        let (count, links) = (self.count(), arcs.len());
        let begins = (0..count as u32).filter(|&run| self.begins[run as usize]);
        arcs.extend(begins.map(|run| Arc { price: BEGIN, tail: count as u32, head: run }));
        let entered = cheapest(count + 1, arcs).unwrap_or_default();
        let used: Vec<usize> =
            entered.into_iter().map(|arc| arc as usize).filter(|&arc| arc < links).collect();
        // Links that lead everywhere are known from the beginning.
        debug_assert_eq!(used.len() + 1, count);
        used
    }
}

/// The arc of a link from one run to another.
fn arc(tail: u32, head: u32, price: i64, runs: &[[i64; 2]]) -> Arc {
    Arc { price: price + runs[tail as usize][1] + runs[head as usize][0], tail, head }
}
