//! One trait behind which every way of ordering lives. Adding one is a file and a line in [`strategy`].

use super::detours::Detours;
use super::{AsSliced, Christofides, ChristofidesOpen, Cost, Greedy, Nearest, Optimized, Problem, Sequence};
use crate::profile::{Effort, OrderStrategy};

/// A way of ordering a layer.
pub trait Strategy: Sync {
    /// Draws every item of the problem once, precedence kept (see [`super::check`]), and tries to keep the
    /// links cheap (see [`super::evaluate`]). The same arguments give the same sequence on every machine
    /// and in every thread. An empty problem gives an empty sequence.
    fn solve(&self, problem: &Problem, cost: &Cost, effort: Effort) -> Sequence;

    /// Solves a problem again, of which it is known only now where the nozzle comes from and where it goes to, from a solution of
    /// its own. The default begins anew.
    fn resume(&self, problem: &Problem, cost: &Cost, effort: Effort, _sequence: Sequence) -> Sequence {
        self.solve(problem, cost, effort)
    }

    /// Improves a solution of its own where travels cost more than straight lines because they lead round something.
    /// The default leaves it as it is.
    fn refine(
        &self,
        _problem: &Problem,
        _effort: Effort,
        _detours: &Detours,
        sequence: Sequence,
    ) -> Sequence {
        sequence
    }

    /// Whether consecutive layers are better solved together, as the stages of one problem, than one after the other.
    fn looks_ahead(&self) -> bool {
        false
    }
}

/// The strategy that a setting names.
pub fn strategy(name: OrderStrategy) -> &'static dyn Strategy {
    match name {
        OrderStrategy::AsSliced => &AsSliced,
        OrderStrategy::Nearest => &Nearest,
        OrderStrategy::Greedy => &Greedy,
        OrderStrategy::Christofides => &Christofides,
        OrderStrategy::ChristofidesOpen => &ChristofidesOpen,
        OrderStrategy::Optimized => &Optimized,
    }
}
