//! What strategies have in common.

use super::cost::Cost;
use super::detours::Detours;
use super::options::Effort;
use super::problem::{Problem, Sequence};
use super::watch::Watch;

/// A strategy that orders a layer.
pub trait Strategy: Sync {
    /// Draws every item of the problem once, precedence kept (see [`super::check`]), and tries to keep the
    /// links cheap (see [`super::evaluate`]). The same arguments give the same sequence on every machine
    /// and in every thread. An empty problem gives an empty sequence.
    fn solve(&self, problem: &Problem, cost: &Cost, effort: Effort) -> Sequence;

    /// As [`Self::solve`], with what else is known. The default makes nothing of it.
    fn solve_knowing(&self, problem: &Problem, cost: &Cost, effort: Effort, _known: Known) -> Sequence {
        self.solve(problem, cost, effort)
    }

    /// Whether consecutive layers are better solved together, as the stages of one problem, than one after the other.
    fn looks_ahead(&self) -> bool {
        false
    }
}

/// Optional inputs of a strategy.
#[derive(Clone, Debug, Default)]
pub struct Known<'a> {
    /// What links inside islands cost, where they lead round something; `None`: they go straight.
    pub detours: Option<&'a Detours<'a>>,
    /// A solution that the strategy found before it was known where the nozzle comes from and where it goes to.
    pub solved: Option<Sequence>,
    /// Steps of the search for each item, beyond those that the effort stands for. A step is a link cost looked at.
    pub more_steps: u64,
    /// Who may end a long search.
    pub watch: Watch<'a>,
}
