//! Pieces at which a solution has no links.

use super::super::model::Model;
use super::super::relaxation::Relaxation;
use super::simplex::Solution;

/// Shares that count as none.
const NONE: f64 = 1e-4;

/// Pieces without links: whichever set they are of, a solution violates it as much. The set that holds off most other solutions is
/// the one in which they are with what is near to them. (A layer of 25 paths took a third of the time, and its bound came from 11 % to 5 %
/// below the solution.)
pub(super) struct Aside {
    touched: Vec<bool>,
    /// For each piece without links the one, with links, of another path that the shortest link leads to.
    near: Vec<Option<u32>>,
}

impl Aside {
    pub(super) fn new(relaxation: &Relaxation, solution: &Solution) -> Self {
        let mut touched = vec![false; relaxation.model.terminals.len()];
        for (link, _) in solution.used_links(relaxation, NONE) {
            (touched[link.a as usize], touched[link.b as usize]) = (true, true);
        }
        for (_, end, _) in solution.used_ends(relaxation, NONE) {
            touched[end.terminal as usize] = true;
        }
        let mut near: Vec<Option<(i64, u32)>> = vec![None; touched.len()];
        for link in relaxation.links.iter().flatten() {
            for (t, other) in [(link.a, link.b), (link.b, link.a)] {
                let found = (link.cost, other);
                if !touched[t as usize]
                    && touched[other as usize]
                    && near[t as usize].is_none_or(|at| found < at)
                {
                    near[t as usize] = Some(found);
                }
            }
        }
        Self { touched, near: near.into_iter().map(|found| Some(found?.1)).collect() }
    }

    /// Decides which pieces without links belong to a set: of a loop that lies on one side all.
    pub(super) fn assign(&self, model: &Model, is_in: &mut [bool]) {
        for body in model.bodies.iter().filter(|body| body.closed) {
            let (touched, others): (Vec<u32>, Vec<u32>) =
                (body.first..body.last).partition(|&t| self.touched[t as usize]);
            let inside = touched.iter().filter(|&&t| is_in[t as usize]).count();
            for t in others {
                let beside = || touched.iter().copied().min_by_key(|&other| model.cheapest(t, other));
                is_in[t as usize] = match inside {
                    0 => false,
                    all if all == touched.len() => true,
                    _ => self.near[t as usize].or_else(beside).is_some_and(|other| is_in[other as usize]),
                };
            }
        }
    }
}
