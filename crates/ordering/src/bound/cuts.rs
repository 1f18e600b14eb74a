//! Sets of terminals that a walk must leave more often than a tree does.
//!
//! A set in which an odd number of links ends is left at least once. A set that no open path leaves is left at least twice if
//! a loop is entered in it (Fischetti, Salazar & Toth 1997, <https://doi.org/10.1287/opre.45.3.378>, for generalised tours):
//! this holds for sets with some pieces of a loop, too. A set that holds the start and a run, but neither the
//! end nor another run that must come before that one, is left at least three times: out to the earlier run, back in,
//! and out to the end (Ruland & Rodin 1997, <https://doi.org/10.1016/S0898-1221(97)00090-4>, for pickups and deliveries).

use rustc_hash::FxHashSet;

use super::link::Link;
use super::model::Model;
use pathwright_geometry::DisjointSets;

/// Shares of the recent trees by which links are classified as in or out, when sets are looked for.
const SHARES: [f64; 9] = [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8];
/// Sets that the recent trees left less often than they must, on average, by more than this become cuts.
const SLACK: f64 = 0.05;

/// The cuts found so far.
pub(super) struct Cuts {
    pub(super) members: Vec<Vec<u32>>,
    /// How often a walk leaves each, at least;
    pub(super) least: Vec<i32>,
    /// where that holds only if a loop is entered at a certain piece, this piece.
    pub(super) guard: Vec<Option<u32>>,
    /// Cuts that each terminal guards.
    pub(super) guarded: Vec<Vec<u32>>,
    known: FxHashSet<(Vec<u32>, Option<u32>)>,
    /// Cuts of each terminal, ascending; the last entry is the start's.
    pub(super) of: Vec<Vec<u32>>,
}

impl Cuts {
    pub(super) fn new(terminals: usize) -> Self {
        let of = vec![Vec::new(); terminals + 1];
        Self {
            members: Vec::new(),
            least: Vec::new(),
            guard: Vec::new(),
            guarded: vec![Vec::new(); terminals],
            known: FxHashSet::default(),
            of,
        }
    }

    /// Cuts that hold both terminals.
    pub(super) fn shared(&self, a: u32, b: u32) -> impl Iterator<Item = u32> {
        common(&self.of[a as usize], &self.of[b as usize])
    }

    /// The cuts of each terminal that have a multiplier above zero.
    pub(super) fn active(&self, multipliers: &[i64]) -> Vec<Vec<u32>> {
        let active =
            |of: &Vec<u32>| of.iter().copied().filter(|&cut| multipliers[cut as usize] > 0).collect();
        self.of.iter().map(active).collect()
    }

    fn add(&mut self, members: Vec<u32>, least: i32, guard: Option<u32>) {
        if self.known.insert((members.clone(), guard)) {
            let cut = self.members.len() as u32;
            for &t in &members {
                self.of[t as usize].push(cut);
            }
            if let Some(t) = guard {
                self.guarded[t as usize].push(cut);
            }
            self.members.push(members);
            self.least.push(least);
            self.guard.push(guard);
        }
    }

    /// Adds sets that recent trees left too seldom, among the parts that the links used in more than some share of them
    /// connect (a heuristic of Padberg & Rinaldi 1990, <https://doi.org/10.1007/BF01580861>): odd ones, and those in
    /// which a loop is entered. Loops are taken whole, and then by pieces.
    pub(super) fn separate_parts(&mut self, model: &Model, links: &[Link], trees: u32) {
        let mut degrees = vec![0; model.terminals.len()];
        for link in links {
            degrees[link.a as usize] += link.used;
            degrees[link.b as usize] += link.used;
        }
        for whole in [true, false].into_iter().filter(|&whole| whole || model.has_pieces()) {
            for share in SHARES {
                let mut parts = DisjointSets::new(model.terminals.len());
                for body in model.bodies.iter().filter(|body| body.closed && whole) {
                    (body.first + 1..body.last).for_each(|t| {
                        parts.join(body.first, t);
                    });
                }
                let often = |link: &&Link| f64::from(link.used) > share * f64::from(trees);
                for link in links.iter().filter(often) {
                    parts.join(link.a, link.b);
                }
                self.add_odd(model, links, &mut parts, trees);
                for body in model.bodies.iter().filter(|body| !body.closed) {
                    parts.join(body.first, body.first + 1);
                }
                self.add_entered(model, links, &mut parts, (&degrees, trees));
            }
        }
    }

    fn add_odd(&mut self, model: &Model, links: &[Link], parts: &mut DisjointSets, trees: u32) {
        for (members, leaving) in left(links, parts, model.terminals.len()) {
            let odd = members.iter().filter(|&&t| model.is_end(t)).count() % 2 == 1;
            if odd && members.len() > 1 && f64::from(leaving) < (1.0 - SLACK) * f64::from(trees) {
                self.add(members, 1, None);
            }
        }
    }

    fn add_entered(
        &mut self,
        model: &Model,
        links: &[Link],
        parts: &mut DisjointSets,
        (degrees, trees): (&[u32], u32),
    ) {
        for (members, leaving) in left(links, parts, model.terminals.len()) {
            let pieces = members.iter().filter(|&&t| !model.is_end(t));
            let Some(&guard) = pieces.max_by_key(|&&t| degrees[t as usize]) else { continue };
            // Where a loop is entered, two links end.
            let entered = degrees[guard as usize];
            if members.len() > 1 && f64::from(leaving) < f64::from(entered) - SLACK * f64::from(trees) {
                self.add(members, 2, Some(guard));
            }
        }
    }

    /// Adds the sets of whole runs that recent trees left less than three times on average, for every two runs of which
    /// one must directly precede the other: least cuts between the start with the later one and the end with the earlier
    /// one. `ends_used` are terminals where trees began and ended, with the number of trees.
    pub(super) fn separate_precedence(
        &mut self,
        model: &Model,
        links: &[Link],
        ends_used: [&[(u32, u32)]; 2],
        trees: u32,
    ) {
        let run_of = model.run_of();
        let runs = run_of.iter().max().map_or(0, |&last| last + 1);
        let run = |t: u32| run_of[model.terminals[t as usize].item as usize];
        let (start, end) = (runs, runs + 1);
        let between = links.iter().map(|link| (run(link.a), run(link.b), link.used));
        let ends = [(start, ends_used[0]), (end, ends_used[1])];
        let ends = ends
            .into_iter()
            .flat_map(|(node, terminals)| terminals.iter().map(move |&(t, used)| (node, run(t), used)));
        let network = Network::new(runs + 2, between.chain(ends));
        let enough = ((3.0 - SLACK) * f64::from(trees)) as u32;
        for (earlier, later) in model.successions(&run_of) {
            if let Some(side) = network.least_cut([start, later], [earlier, end], enough) {
                let mut members: Vec<u32> =
                    (0..model.terminals.len() as u32).filter(|&t| side[run(t) as usize]).collect();
                members.push(model.terminals.len() as u32);
                self.add(members, 3, None);
            }
        }
    }
}

/// What two ascending lists have in common.
pub(super) fn common<'a>(a: &'a [u32], b: &'a [u32]) -> impl Iterator<Item = u32> + 'a {
    let mut rest = b;
    a.iter().copied().filter(move |cut| {
        let below = rest.iter().take_while(|other| *other < cut).count();
        rest = &rest[below..];
        rest.first() == Some(cut)
    })
}

/// The members of each part, and how often recent trees left it.
fn left(links: &[Link], parts: &mut DisjointSets, terminals: usize) -> impl Iterator<Item = (Vec<u32>, u32)> {
    let mut leaving = vec![0; terminals];
    for link in links {
        let ends = [link.a, link.b].map(|t| parts.find(t));
        for end in ends.into_iter().filter(|_| ends[0] != ends[1]) {
            leaving[end as usize] += link.used;
        }
    }
    let mut members = vec![Vec::new(); terminals];
    (0..terminals as u32).for_each(|t| members[parts.find(t) as usize].push(t));
    members.into_iter().zip(leaving).filter(|(members, _)| !members.is_empty())
}

/// An undirected graph with capacities.
struct Network {
    rows: Vec<u32>,
    /// Head of each arc, and the number of the arc back.
    arcs: Vec<(u32, u32)>,
    capacities: Vec<u32>,
}

impl Network {
    fn new(nodes: u32, edges: impl Iterator<Item = (u32, u32, u32)>) -> Self {
        let mut edges: Vec<_> =
            edges.filter(|e| e.0 != e.1 && e.2 > 0).map(|(u, v, used)| (u.min(v), u.max(v), used)).collect();
        edges.sort_unstable();
        let mut both: Vec<(u32, u32, u32)> = Vec::new();
        for pair in edges.chunk_by(|e, f| (e.0, e.1) == (f.0, f.1)) {
            let capacity = pair.iter().map(|e| e.2).sum();
            both.extend([(pair[0].0, pair[0].1, capacity), (pair[0].1, pair[0].0, capacity)]);
        }
        both.sort_unstable();
        let row = |u: u32, v: u32| both.partition_point(|arc| (arc.0, arc.1) < (u, v)) as u32;
        Self {
            rows: (0..=nodes).map(|u| row(u, 0)).collect(),
            arcs: both.iter().map(|&(u, v, _)| (v, row(v, u))).collect(),
            capacities: both.iter().map(|arc| arc.2).collect(),
        }
    }

    /// The sources' side of a least cut, if it is below `enough`. Edmonds & Karp 1972
    /// (<https://doi.org/10.1145/321694.321699>).
    fn least_cut(&self, sources: [u32; 2], sinks: [u32; 2], enough: u32) -> Option<Vec<bool>> {
        const NONE: u32 = u32::MAX;
        let nodes = self.rows.len() - 1;
        let mut left = self.capacities.clone();
        let mut flow = 0;
        while flow < enough {
            let mut by = vec![NONE; nodes];
            let mut reached = vec![false; nodes];
            let mut queue = sources.to_vec();
            sources.iter().for_each(|&source| reached[source as usize] = true);
            let mut at = 0;
            while at < queue.len() && !sinks.iter().any(|&sink| reached[sink as usize]) {
                let u = queue[at];
                at += 1;
                for arc in self.rows[u as usize]..self.rows[u as usize + 1] {
                    let (v, _) = self.arcs[arc as usize];
                    if left[arc as usize] > 0 && !std::mem::replace(&mut reached[v as usize], true) {
                        by[v as usize] = arc;
                        queue.push(v);
                    }
                }
            }
            let Some(&sink) = sinks.iter().find(|&&sink| reached[sink as usize]) else {
                return Some(reached);
            };
            let path = || {
                std::iter::successors(Some(by[sink as usize]), |&arc| {
                    let (tail, _) = self.arcs[self.arcs[arc as usize].1 as usize];
                    Some(by[tail as usize]).filter(|&arc| arc != NONE)
                })
            };
            let more = path().map(|arc| left[arc as usize]).min().unwrap_or(enough);
            for arc in path() {
                left[arc as usize] -= more;
                left[self.arcs[arc as usize].1 as usize] += more;
            }
            flow += more;
        }
        None
    }
}
