//! Local search, then iterated local search.

mod blocks;
mod chains;
mod end;
mod exchange;
mod gaps;
mod grid;
mod junctions;
mod loops;
mod neighbours;
mod refine;
mod runs;
mod search;
mod start;
mod state;
mod vicinity;
mod walk;

use self::state::Search;
use super::precedence::Groups;
use super::{Cost, Known, Problem, Sequence, Strategy, evaluate};
use crate::options::{Effort, Scope};
use pathwright_geometry::Random;

/// Steps of iterated search per path. A step is a link cost looked at.
///
/// `fast` only descends at `layer` scope, to 0.80 of nearest, and does little more at the others; `normal` buys the next 2 %.
/// Precedence leaves less to be found: `docs/ordering.md` has the figures.
fn steps_per_path(effort: Effort, scope: Scope) -> u64 {
    match (effort, scope) {
        (Effort::Fast, Scope::Layer) => 0,
        (Effort::Fast, _) => 50,
        (Effort::Normal, Scope::Layer) => 2_000,
        (Effort::Normal, _) => 750,
        (Effort::High, Scope::Layer) => 60_000,
        (Effort::High, _) => 20_000,
    }
}

/// Least number of steps of a layer on average, enough to find the optimum of a handful of paths, except with `fast`.
fn least_steps(effort: Effort) -> u64 {
    match effort {
        Effort::Fast => 0,
        Effort::Normal => 5_000,
        Effort::High => 100_000,
    }
}

/// Stages of so few items, on average, are entered anew together at the end.
const FEW: usize = 6;

/// Stages of so few items are searched thoroughly: with less effort that takes a tenth of slicing a small model, and makes no print
/// quicker than entering its paths anew at the end.
fn few(effort: Effort) -> usize {
    if effort == Effort::High { FEW } else { 0 }
}

/// A solution that was found before gets one step in this many: only its ends are new.
const RESUMED: u64 = 4;

/// Starts from greedy at `layer` scope, from nearest at the others; descends by 3-opt with neighbour lists, by entering loops
/// elsewhere and moving them, and by moving whole runs and islands; then kicks and repairs it for as long as the effort allows.
///
/// Stages are begun one after the other, each from where the last one ended; kicks then take all together, so that each
/// comes to end where it suits the next.
///
/// Never more expensive than [`Nearest`](super::Nearest).
#[derive(Clone, Copy, Debug)]
pub struct Optimized;

impl Strategy for Optimized {
    fn solve(&self, problem: &Problem, cost: &Cost, effort: Effort) -> Sequence {
        self.solve_knowing(problem, cost, effort, Known::default())
    }

    fn solve_knowing(&self, problem: &Problem, cost: &Cost, effort: Effort, known: Known) -> Sequence {
        let Known { detours, solved, more_steps, watch } = known;
        let groups = Groups::new(problem);
        let count = problem.items.len() as u64;
        let stages = groups.stages().count() as u64;
        let steps =
            (count * (steps_per_path(effort, problem.scope) + more_steps)).max(stages * least_steps(effort));
        let mut search = Search::new(problem, &groups, *cost, few(effort), watch);
        match &solved {
            Some(solved) => search.take_up(solved),
            None => search.begin(),
        }
        // What was found with detours in mind is not to be lost to straight lines.
        let led = detours.filter(|_| solved.is_some());
        led.inspect(|detours| search.use_detours(detours));
        search.end();
        let steps = if solved.is_some() { steps / RESUMED } else { steps };
        search.iterate(1..count as u32 + 1, &mut Random::new(count), steps);
        if count <= stages * FEW as u64 {
            search.enter_best();
        }
        if led.is_none() {
            let nearest = search.nearest();
            if evaluate(problem, &nearest, cost) < evaluate(problem, &search.sequence(), cost) {
                search = Search::new(problem, &groups, *cost, few(effort), watch);
                search.take_up(&nearest);
                search.end();
            }
            detours.inspect(|detours| search.use_detours(detours));
        }
        if detours.is_some() {
            search.refine(steps_per_path(effort, problem.scope));
        }
        search.sequence()
    }

    fn looks_ahead(&self) -> bool {
        true
    }
}
