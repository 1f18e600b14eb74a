//! Local search, then iterated local search.

mod chains;
mod exchange;
mod loops;
mod neighbours;
mod random;
mod runs;
mod search;
mod walk;

use self::random::Random;
use self::search::Search;
use super::index::Index;
use super::precedence::Groups;
use super::{Cost, Nearest, Problem, Sequence, Strategy, evaluate};
use crate::profile::Effort;

/// Steps of iterated search per path: what the efforts' time budgets buy.
fn steps_per_path(effort: Effort) -> u64 {
    match effort {
        Effort::Fast => 0,
        Effort::Normal => 4_000,
        Effort::High => 60_000,
    }
}

/// Starts from nearest, descends by 3-opt with neighbour lists, by entering loops elsewhere and moving them, and by
/// moving whole runs and islands; then kicks and repairs it for as long as the effort allows.
///
/// Never dearer than [`Nearest`].
#[derive(Clone, Copy, Debug)]
pub struct Optimized;

impl Strategy for Optimized {
    fn solve(&self, problem: &Problem, cost: &Cost, effort: Effort) -> Sequence {
        let start = Nearest.solve(problem, cost, effort);
        if start.is_empty() {
            return start;
        }
        let groups = Groups::new(problem);
        let mut index = Index::new(problem, &groups);
        (0..groups.items.len() as u32).for_each(|group| index.open(group));
        let mut search = Search::new(problem, &groups, index, *cost, &start);
        search.descend();
        let paths = problem.items.len() as u64;
        search.iterate(&mut Random::new(paths), paths * steps_per_path(effort));
        let found = search.sequence();
        if evaluate(problem, &found, cost) <= evaluate(problem, &start, cost) { found } else { start }
    }
}
