//! Passages that a solution makes too seldom.

use super::super::network::Network;
use super::super::passages::Passage;
use super::super::relaxation::Relaxation;
use super::simplex::Solution;

/// Shares as integers.
const ONE: u32 = 1_000_000;
/// What is violated by less is not.
const SLACK: f64 = 0.02;
const ENOUGH: u32 = ((1.0 - SLACK) * ONE as f64) as u32;

/// Adds passages that a solution makes less than once: out of sets around each run to what may come later, into such sets from what
/// may come earlier, and from each run to those of its island that must come after it. How many.
pub(super) fn separate(relaxation: &mut Relaxation, solution: &Solution) -> usize {
    let Some(directions) = &relaxation.directions else { return 0 };
    let graph = Graph::new(relaxation, &directions.run_of, directions.count(), solution);
    let found: Vec<Passage> = graph.pairs.iter().filter_map(|&[from, to]| graph.passage(from, to)).collect();
    let known = relaxation.passages.len();
    for passage in found {
        if !relaxation.passages.contains(&passage) {
            relaxation.passages.push(passage);
        }
    }
    relaxation.passages.len() - known
}

/// Stage, island and rank of a run.
type Place = (u32, u32, u32);

fn precedes(one: &Place, other: &Place) -> bool {
    one.0 < other.0 || (one.0, one.1) == (other.0, other.1) && one.2 < other.2
}

/// Runs, what is before the walk and what is after it, and how often a solution goes from one to another.
struct Graph {
    arcs: Vec<(u32, u32, u32)>,
    /// What must come before each, and after it.
    before: Vec<Vec<bool>>,
    after: Vec<Vec<bool>>,
    /// Nodes of which the first comes before the second.
    pairs: Vec<[usize; 2]>,
}

impl Graph {
    fn new(relaxation: &Relaxation, run_of: &[u32], runs: usize, solution: &Solution) -> Self {
        let whole = |share: f64| (share * f64::from(ONE)) as u32;
        let [start, end] = [runs as u32, runs as u32 + 1];
        let between = solution.arcs.iter().map(|&(tail, head, share)| (tail, head, whole(share)));
        let ends = solution.used_ends(relaxation, 0.0).filter_map(|(side, at, share)| {
            let run = relaxation.run_of(at)? as u32;
            Some(if side == 0 { (start, run, whole(share)) } else { (run, end, whole(share)) })
        });
        let mut places = vec![Place::default(); runs];
        for (body, &run) in relaxation.model.bodies.iter().zip(run_of) {
            places[run as usize] = (body.groups[0], body.place.island, body.rank);
        }
        Self::of(&places, between.chain(ends).collect())
    }

    fn of(places: &[Place], arcs: Vec<(u32, u32, u32)>) -> Self {
        let runs = places.len();
        let mut graph = Self {
            arcs,
            before: vec![vec![false; runs + 2]; runs + 2],
            after: vec![vec![false; runs + 2]; runs + 2],
            pairs: (0..runs).flat_map(|run| [[run, runs + 1], [runs, run]]).collect(),
        };
        for (i, one) in places.iter().enumerate() {
            for (j, other) in places.iter().enumerate().filter(|(_, other)| precedes(one, other)) {
                (graph.before[j][i], graph.after[i][j]) = (true, true);
                graph.pairs.extend((one.0 == other.0).then_some([i, j]));
            }
        }
        graph
    }

    /// A passage between sets around two nodes of which the first comes before the second, if one is made too seldom.
    fn passage(&self, from: usize, to: usize) -> Option<Passage> {
        let nodes = self.before.len();
        let is_left = |node: u32| !self.before[from][node as usize] && !self.after[to][node as usize];
        let arcs = self.arcs.iter().copied().filter(|&(tail, head, _)| is_left(tail) && is_left(head));
        let network = Network::directed(nodes as u32, arcs);
        let mut side = network.least_cut(&[(from as u32, ENOUGH)], &[to as u32], ENOUGH)?;
        // What is after the walk leads nowhere.
        side[nodes - 1] |= to != nodes - 1;
        let [start, end] = [nodes - 2, nodes - 1];
        let precedes = |node: usize| node == from || from != start && (to == end || self.after[node][to]);
        let firsts: Vec<usize> = (0..nodes).filter(|&node| side[node] && precedes(node)).collect();
        let is_last = |&node: &usize| {
            !side[node]
                && (node == to || firsts.iter().all(|&first| first == start || self.after[first][node]))
        };
        let lasts: Vec<usize> = (0..nodes).filter(is_last).collect();
        let bars = |node: usize| {
            firsts.iter().any(|&first| self.before[first][node])
                || lasts.iter().any(|&last| self.after[last][node])
        };
        let barred: Vec<bool> = (0..nodes).map(bars).collect();
        let of = |is_source: bool| (0..nodes).map(|node| side[node] == is_source && !barred[node]).collect();
        Some(Passage { from: of(true), to: of(false) })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Every order of runs in which none comes before one that precedes it.
    fn orders(places: &[Place], order: &mut Vec<u32>, each: &mut impl FnMut(&[u32])) {
        if order.len() == places.len() {
            return each(order);
        }
        let left: Vec<u32> = (0..places.len() as u32).filter(|run| !order.contains(run)).collect();
        for &run in &left {
            if !left.iter().any(|&other| precedes(&places[other as usize], &places[run as usize])) {
                order.push(run);
                orders(places, order, each);
                order.pop();
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 2000, ..ProptestConfig::default() })]

        #[test]
        fn every_order_makes_every_passage(
            places in prop::collection::vec((0..2u32, 0..3u32, 0..3u32), 1..7),
            arcs in prop::collection::vec((0..8u32, 0..8u32, 0..ONE), 0..30),
        ) {
            let nodes = places.len() as u32 + 2;
            let arcs = arcs.into_iter().map(|(tail, head, share)| (tail % nodes, head % nodes, share));
            let arcs = arcs.filter(|&(tail, head, _)| tail + 1 != nodes && head + 2 != nodes).collect();
            let graph = Graph::of(&places, arcs);
            let passages: Vec<Passage> =
                graph.pairs.iter().filter_map(|&[from, to]| graph.passage(from, to)).collect();
            let mut failed = None;
            orders(&places, &mut Vec::new(), &mut |order| {
                let walk: Vec<u32> =
                    [nodes - 2].into_iter().chain(order.iter().copied()).chain([nodes - 1]).collect();
                let makes = |passage: &Passage| walk.windows(2).any(|link| passage.holds(link[0], link[1]));
                if !passages.iter().all(makes) {
                    failed = Some(walk);
                }
            });
            prop_assert_eq!(failed, None);
        }
    }
}
