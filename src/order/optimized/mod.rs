//! Local search, then iterated local search.

mod chains;
mod exchange;
mod grid;
mod loops;
mod neighbours;
mod random;
mod runs;
mod search;
mod walk;

use self::random::Random;
use self::search::Search;
use super::precedence::Groups;
use super::{Cost, Greedy, Nearest, Problem, Sequence, Strategy, evaluate};
use crate::profile::{Effort, Scope};

/// Steps of iterated search per path. A step is a link cost looked at.
///
/// `fast` ends where the curve of cost over time bends, at `layer` scope at 0.81 of nearest; `normal` buys the next
/// 3 % there. Precedence leaves less to be found at the other scopes, where `normal` is the default and must stay cheap:
/// `docs/ordering.md` has the figures.
fn steps_per_path(effort: Effort, scope: Scope) -> u64 {
    match (effort, scope) {
        (Effort::Fast, Scope::Layer) => 100,
        (Effort::Fast, _) => 50,
        (Effort::Normal, Scope::Layer) => 2_000,
        (Effort::Normal, _) => 300,
        (Effort::High, Scope::Layer) => 60_000,
        (Effort::High, _) => 20_000,
    }
}

/// Steps that every layer gets, however few its paths: enough to find the optimum of a handful of them.
fn least_steps(effort: Effort) -> u64 {
    match effort {
        Effort::Fast => 500,
        Effort::Normal => 5_000,
        Effort::High => 100_000,
    }
}

/// Starts from greedy at `layer` scope, from nearest at the others; descends by 3-opt with neighbour lists, by entering loops elsewhere and moving them, and by
/// moving whole runs and islands; then kicks and repairs it for as long as the effort allows.
///
/// Never dearer than [`Nearest`].
#[derive(Clone, Copy, Debug)]
pub struct Optimized;

impl Strategy for Optimized {
    fn solve(&self, problem: &Problem, cost: &Cost, effort: Effort) -> Sequence {
        let nearest = Nearest.solve(problem, cost, effort);
        if nearest.is_empty() {
            return nearest;
        }
        // Fragments that were joined shortest first leave less to mend; but where runs must not be mixed, choosing
        // the next run by the nearest of its ends matters more, and nearest begins lower.
        let greedy = (problem.scope == Scope::Layer).then(|| Greedy.solve(problem, cost, effort));
        let start = greedy.as_ref().unwrap_or(&nearest);
        let groups = Groups::new(problem);
        let mut search = Search::new(problem, &groups, *cost, start);
        search.descend();
        let paths = problem.items.len() as u64;
        let budget = (paths * steps_per_path(effort, problem.scope)).max(least_steps(effort));
        search.iterate(&mut Random::new(paths), budget);
        let found = search.sequence();
        if evaluate(problem, &found, cost) <= evaluate(problem, &nearest, cost) { found } else { nearest }
    }
}
