//! Sets of terminals that some link must leave, because an odd number of links ends in them.

use rustc_hash::FxHashSet;

use super::super::parts::Parts;
use super::model::Model;
use super::tree::Link;

/// Shares of the recent trees by which links are told to be in or out, when sets are looked for.
const SHARES: [f64; 9] = [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8];
/// Sets that the recent trees left less often than this, on average, become cuts.
const SELDOM: f64 = 0.95;

/// The cuts found so far.
pub(super) struct Cuts {
    pub(super) members: Vec<Vec<u32>>,
    known: FxHashSet<Vec<u32>>,
    /// Cuts of each terminal, ascending.
    pub(super) of: Vec<Vec<u32>>,
}

impl Cuts {
    pub(super) fn new(terminals: usize) -> Self {
        Self { members: Vec::new(), known: FxHashSet::default(), of: vec![Vec::new(); terminals] }
    }

    /// Cuts that hold both terminals.
    pub(super) fn shared(&self, a: u32, b: u32) -> impl Iterator<Item = u32> {
        let other = &self.of[b as usize];
        self.of[a as usize].iter().copied().filter(move |cut| other.binary_search(cut).is_ok())
    }

    fn add(&mut self, members: Vec<u32>) {
        if self.known.insert(members.clone()) {
            for &t in &members {
                self.of[t as usize].push(self.members.len() as u32);
            }
            self.members.push(members);
        }
    }

    /// Adds the odd sets that recent trees seldom left, among the parts that the links used in more than some share of
    /// them connect (a heuristic of Padberg & Rinaldi 1990, <https://doi.org/10.1007/BF01580861>). Any odd set is valid.
    pub(super) fn separate(&mut self, model: &Model, links: &[Link], trees: u32) {
        let terminals = model.terminals.len();
        let open = |t: u32| !model.bodies[model.terminals[t as usize].item as usize].closed;
        for share in SHARES {
            let mut parts = Parts::new(terminals);
            // At which of its pieces a loop is entered is not known: a cut holds all of them or none.
            for body in model.bodies.iter().filter(|body| body.closed) {
                for t in body.first + 1..body.last {
                    parts.join(body.first, t);
                }
            }
            for link in links.iter().filter(|link| f64::from(link.used) > share * f64::from(trees)) {
                parts.join(link.a, link.b);
            }
            let mut leaving = vec![0; terminals];
            for link in links {
                let ends = [link.a, link.b].map(|t| parts.find(t));
                for end in ends.into_iter().filter(|_| ends[0] != ends[1]) {
                    leaving[end as usize] += link.used;
                }
            }
            let mut members = vec![Vec::new(); terminals];
            (0..terminals as u32).for_each(|t| members[parts.find(t) as usize].push(t));
            for (members, leaving) in members.into_iter().zip(leaving) {
                let odd = members.iter().filter(|&&t| open(t)).count() % 2 == 1;
                if odd && members.len() > 2 && f64::from(leaving) < SELDOM * f64::from(trees) {
                    self.add(members);
                }
            }
        }
    }
}
