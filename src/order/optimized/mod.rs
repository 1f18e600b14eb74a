//! Local search, then iterated local search.

mod chains;
mod exchange;
mod grid;
mod junctions;
mod loops;
mod neighbours;
mod random;
mod runs;
mod search;
mod walk;

use self::random::Random;
use self::search::Search;
use super::precedence::Groups;
use super::{Cost, Greedy, Nearest, Problem, Sequence, Strategy, Visit, evaluate};
use crate::profile::{Effort, Scope};

/// Steps of iterated search per path. A step is a link cost looked at.
///
/// `fast` ends where the curve of cost over time bends, at `layer` scope at 0.81 of nearest; `normal` buys the next
/// 3 % there. Precedence leaves less to be found at the other scopes, where `normal` is the default and must stay cheap:
/// `docs/ordering.md` has the figures.
fn steps_per_path(effort: Effort, scope: Scope) -> u64 {
    match (effort, scope) {
        (Effort::Fast, Scope::Layer) => 220,
        (Effort::Fast, _) => 50,
        (Effort::Normal, Scope::Layer) => 3_000,
        (Effort::Normal, _) => 300,
        (Effort::High, Scope::Layer) => 60_000,
        (Effort::High, _) => 20_000,
    }
}

/// Steps that a layer gets on average, however few its paths: enough to find the optimum of a handful of them.
fn least_steps(effort: Effort) -> u64 {
    match effort {
        Effort::Fast => 500,
        Effort::Normal => 5_000,
        Effort::High => 100_000,
    }
}

/// Starts from greedy at `layer` scope, from nearest at the others; descends by 3-opt with neighbour lists, by entering loops
/// elsewhere and moving them, and by moving whole runs and islands; then kicks and repairs it for as long as the effort allows.
///
/// Stages are solved one after the other, each from where the last one ended, and then, for the other half of the effort, all
/// together, so that each ends where it suits the next; `fast` does so at once.
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
        let groups = Groups::new(problem);
        let stages: Vec<Vec<u32>> = groups
            .place
            .chunk_by(|a, b| a.stage == b.stage)
            .scan(0, |first, places| {
                let from = std::mem::replace(first, *first + places.len());
                let mut items: Vec<u32> = groups.items[from..*first].concat();
                items.sort_unstable();
                Some(items)
            })
            .collect();
        let steps = |items: usize, stages: usize| {
            let of_items = items as u64 * steps_per_path(effort, problem.scope);
            of_items.max(stages as u64 * least_steps(effort))
        };
        let all = steps(problem.items.len(), stages.len());
        let found = if stages.len() > 1 && effort != Effort::Fast {
            let start = one_after_the_other(problem, &stages, cost, |items| steps(items, 1) / 2);
            improved(problem, &groups, cost, Some(start), all / 2)
        } else {
            improved(problem, &groups, cost, None, all)
        };
        if evaluate(problem, &found, cost) <= evaluate(problem, &nearest, cost) { found } else { nearest }
    }

    fn looks_ahead(&self) -> bool {
        true
    }
}

/// The items of each stage solved from where the stage before ended, in so many steps.
fn one_after_the_other(
    problem: &Problem,
    stages: &[Vec<u32>],
    cost: &Cost,
    steps: impl Fn(usize) -> u64,
) -> Sequence {
    let mut sequence = Sequence::with_capacity(problem.items.len());
    let mut at = problem.start;
    for items in stages {
        let stage = Problem {
            items: items.iter().map(|&item| problem.items[item as usize]).collect(),
            runs: problem.runs.clone(),
            scope: problem.scope,
            start: at,
            end: None,
        };
        let solved = improved(&stage, &Groups::new(&stage), cost, None, steps(items.len()));
        at = solved.last().map(|visit| stage.items[visit.item as usize].ends(visit.entry).1).or(at);
        sequence.extend(solved.iter().map(|visit| Visit { item: items[visit.item as usize], ..*visit }));
    }
    sequence
}

/// A solution after local search and so many steps of iterated local search.
///
/// Without a start: fragments that were joined shortest first leave less to mend; but where runs must not be mixed,
/// choosing the next run by the nearest of its ends matters more, and nearest begins lower.
fn improved(
    problem: &Problem,
    groups: &Groups,
    cost: &Cost,
    start: Option<Sequence>,
    steps: u64,
) -> Sequence {
    let start = start.unwrap_or_else(|| match problem.scope {
        Scope::Layer => Greedy.solve(problem, cost, Effort::Normal),
        Scope::Feature | Scope::Island => Nearest.solve(problem, cost, Effort::Normal),
    });
    let mut search = Search::new(problem, groups, *cost, &start);
    search.descend();
    search.iterate(&mut Random::new(problem.items.len() as u64), steps);
    search.sequence()
}
