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
use super::network::Network;
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
    /// where that holds only if a loop is entered at one of its pieces in the set, this loop.
    pub(super) guard: Vec<Option<u32>>,
    /// Guarded cuts of each piece of their loops.
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

    /// Adds a set of terminals, ascending, that a walk leaves so often at least, if there is a guard: if this loop is entered there.
    /// Whether it is new.
    pub(super) fn add(&mut self, model: &Model, members: Vec<u32>, least: i32, guard: Option<u32>) -> bool {
        let is_new = self.known.insert((members.clone(), guard));
        if is_new {
            let cut = self.members.len() as u32;
            for &t in &members {
                self.of[t as usize].push(cut);
                if guard.is_some_and(|item| model.terminals.get(t as usize).is_some_and(|at| at.item == item))
                {
                    self.guarded[t as usize].push(cut);
                }
            }
            self.members.push(members);
            self.least.push(least);
            self.guard.push(guard);
        }
        is_new
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
                self.add(model, members, 1, None);
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
            // Where a loop is entered, two links end.
            let item = |t: u32| model.terminals[t as usize].item;
            let loops = members.chunk_by(|&a, &b| item(a) == item(b)).filter(|of| !model.is_end(of[0]));
            let entered = |of: &[u32]| of.iter().map(|&t| degrees[t as usize]).sum::<u32>();
            let Some((entered, guard)) = loops.map(|of| (entered(of), item(of[0]))).max() else { continue };
            if members.len() > 1 && f64::from(leaving) < f64::from(entered) - SLACK * f64::from(trees) {
                self.add(model, members, 2, Some(guard));
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
            if let Some(side) =
                network.least_cut(&[(start, enough), (later, enough)], &[earlier, end], enough)
            {
                let mut members: Vec<u32> =
                    (0..model.terminals.len() as u32).filter(|&t| side[run(t) as usize]).collect();
                members.push(model.terminals.len() as u32);
                self.add(model, members, 3, None);
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
