//! Sets of links between runs, with directions, of which every walk makes one at least.
//!
//! Runs that must come before one another make such sets stronger than those around any path: after the last of some runs the walk
//! goes on to a run that is neither among these nor must come before any of them. They are the predecessor, successor and precedence
//! inequalities of Balas, Fischetti & Pulleyblank 1995 (<https://doi.org/10.1007/BF01585767>).

/// The links that lead from one set of runs to another. After all runs come two nodes: what is before the walk, and what is after it.
#[derive(Clone, PartialEq, Eq)]
pub(super) struct Passage {
    pub(super) from: Vec<bool>,
    pub(super) to: Vec<bool>,
}

impl Passage {
    /// Whether the link from one node to another is one of them.
    #[cfg(feature = "highs")]
    pub(super) fn holds(&self, tail: u32, head: u32) -> bool {
        self.from[tail as usize] && self.to[head as usize]
    }
}

/// What a link pays for leading from one node to another, besides what it pays at terminals.
pub(super) struct Fares {
    nodes: usize,
    /// By tail and head.
    prices: Vec<i64>,
}

impl Fares {
    /// `runs`: what links into each run and out of it pay; `gains`: what they get for each passage that they make.
    pub(super) fn new(runs: &[[i64; 2]], passages: &[Passage], gains: &[i64]) -> Self {
        let nodes = runs.len() + 2;
        let leaving = runs.iter().map(|run| run[1]).chain([0, 0]);
        let entering: Vec<i64> = runs.iter().map(|run| run[0]).chain([0, 0]).collect();
        let mut prices: Vec<i64> =
            leaving.flat_map(|leaves| entering.iter().map(move |enters| leaves + enters)).collect();
        let passages = passages.iter().zip(gains);
        for (passage, &price) in passages.filter(|(_, price)| **price > 0) {
            let tails = (0..nodes).filter(|&tail| passage.from[tail]);
            for row in tails.map(|tail| tail * nodes..(tail + 1) * nodes) {
                let heads = prices[row].iter_mut().zip(&passage.to);
                heads.filter(|(_, is_in)| **is_in).for_each(|(at, _)| *at -= price);
            }
        }
        Self { nodes, prices }
    }

    pub(super) fn of(&self, tail: u32, head: u32) -> i64 {
        self.prices[tail as usize * self.nodes + head as usize]
    }

    /// For the link into a walk (0) that begins with a run, or for the one out of it (1).
    pub(super) fn at_end(&self, side: usize, run: u32) -> i64 {
        let before = self.nodes as u32 - 2;
        if side == 0 { self.of(before, run) } else { self.of(run, before + 1) }
    }
}
