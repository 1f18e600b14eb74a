//! The cheapest tree over listed links.

use super::directions::{Directions, RUNS};
use super::link::Link;
use super::model::Model;
use super::passages::Fares;
use pathwright_geometry::DisjointSets;

/// How often a solution of the relaxation uses each thing that has a multiplier.
#[derive(Default)]
pub(super) struct Usage {
    /// Links at each terminal.
    pub(super) degrees: Vec<i32>,
    /// Links with both ends in each cut.
    pub(super) inside: Vec<i32>,
    /// Links at each tie.
    pub(super) tied: Vec<i32>,
    /// Links into each run and out of it, where they have directions.
    pub(super) runs: Vec<[i32; 2]>,
}

impl Usage {
    /// Sets all counts to zero.
    pub(super) fn reset(&mut self, terminals: usize, cuts: usize, ties: usize, runs: usize) {
        self.runs.clear();
        self.runs.resize(runs, [0; 2]);
        for (counts, len) in
            [(&mut self.degrees, terminals), (&mut self.inside, cuts), (&mut self.tied, ties)]
        {
            counts.clear();
            counts.resize(len, 0);
        }
    }
}

/// A spanning tree in the making.
pub(super) struct Forest<'a> {
    pub(super) model: &'a Model,
    pub(super) parts: DisjointSets,
    pub(super) usage: &'a mut Usage,
    pub(super) shared: &'a [u32],
    pub(super) total: i64,
}

impl Forest<'_> {
    /// Joins what the links can join, cheapest first. `keys` are prices and numbers of the links.
    ///
    /// Kruskal with a quicksort whose heavy part is rid of links that have become idle before its turn comes (Osipov,
    /// Sanders & Singler 2009, <https://doi.org/10.1137/1.9781611972894.5>).
    pub(super) fn span(&mut self, links: &mut [Link], keys: &mut [(i64, u32)]) {
        const SMALL: usize = 64;
        if keys.len() <= SMALL {
            keys.sort_unstable();
            for &(price, k) in &*keys {
                self.take(&mut links[k as usize], price);
            }
            return;
        }
        let (light, middle, heavy) = keys.select_nth_unstable(keys.len() / 4);
        self.span(links, light);
        self.take(&mut links[middle.1 as usize], middle.0);
        let mut kept = 0;
        for at in 0..heavy.len() {
            let [i, j] = links[heavy[at].1 as usize].items(self.model);
            if self.parts.find(i) != self.parts.find(j) {
                heavy.swap(kept, at);
                kept += 1;
            }
        }
        self.span(links, &mut heavy[..kept]);
    }

    /// Joins what the links of a cheapest arborescence over the runs join. `keys` are as in [`Self::span`].
    pub(super) fn span_runs(
        &mut self,
        directions: &Directions,
        depth: usize,
        links: &mut [Link],
        keys: &[(i64, u32)],
        fares: &Fares,
    ) {
        let found = match depth {
            RUNS => directions.span(self.model, links, keys, fares),
            _ => directions.climb(self.model, links, keys, fares),
        };
        for (link, arc) in found {
            self.usage.runs[arc.tail as usize][1] += 1;
            self.usage.runs[arc.head as usize][0] += 1;
            self.take(&mut links[link as usize], arc.price);
        }
    }

    fn take(&mut self, link: &mut Link, price: i64) {
        let [i, j] = link.items(self.model);
        if !self.parts.join(i, j) {
            return;
        }
        self.total += price;
        link.used += 1;
        for t in [link.a, link.b] {
            self.usage.degrees[t as usize] += 1;
        }
        for tie in link.ties {
            self.usage.tied[tie as usize] += 1;
        }
        for &cut in link.shared(self.shared) {
            self.usage.inside[cut as usize] += 1;
        }
    }
}
