//! The checker that every strategy's result goes through.

use rustc_hash::FxHashMap;

use super::options::Scope;
use super::{Problem, Visit};

/// Why a sequence is no solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs)]
pub enum Fault {
    #[error("step {step}: there is no path {item}")]
    NoSuchItem { step: usize, item: u32 },
    #[error("step {step}: path {item} cannot be entered at {entry}")]
    NoSuchEntry { step: usize, item: u32, entry: u32 },
    #[error("step {step}: path {item} is drawn a second time")]
    Twice { step: usize, item: u32 },
    #[error("path {item} is not drawn")]
    Missing { item: u32 },
    #[error("step {step}: path {item} comes after paths that it must precede")]
    Precedence { step: usize, item: u32 },
    #[error("step {step}: path {item} interrupts a run or continues an interrupted one")]
    Interrupted { step: usize, item: u32 },
}

/// Whether a sequence draws every item of the problem once, enters each where it may be entered, and keeps
/// the precedence that [`Problem`] states. O(n).
///
/// # Errors
/// The first fault found, with the step (index into `sequence`) where it shows.
pub fn check(problem: &Problem, sequence: &[Visit]) -> Result<(), Fault> {
    let mut drawn = vec![false; problem.items.len()];
    for (step, &Visit { item, entry }) in sequence.iter().enumerate() {
        let Some(shape) = problem.items.get(item as usize).map(|item| item.shape) else {
            return Err(Fault::NoSuchItem { step, item });
        };
        if entry as usize >= shape.entries().len() {
            return Err(Fault::NoSuchEntry { step, item, entry });
        }
        if std::mem::replace(&mut drawn[item as usize], true) {
            return Err(Fault::Twice { step, item });
        }
    }
    if let Some(item) = drawn.iter().position(|drawn| !drawn) {
        return Err(Fault::Missing { item: item as u32 });
    }
    precedence(problem, sequence)
}

/// The part of [`check`] that concerns the order; every item is known to occur once.
fn precedence(problem: &Problem, sequence: &[Visit]) -> Result<(), Fault> {
    let mut begun = vec![false; problem.runs.len()];
    let mut islands_begun = FxHashMap::default();
    let mut last: Option<u32> = None;
    for (step, &Visit { item, .. }) in sequence.iter().enumerate() {
        let run_index = problem.items[item as usize].run;
        if last == Some(run_index) {
            continue;
        }
        let run = problem.runs[run_index as usize];
        let before = last.map(|index| problem.runs[index as usize]);
        if before.is_some_and(|before| before.stage > run.stage) {
            return Err(Fault::Precedence { step, item });
        }
        last = Some(run_index);
        if problem.scope == Scope::Layer {
            continue;
        }
        if std::mem::replace(&mut begun[run_index as usize], true) {
            return Err(Fault::Interrupted { step, item });
        }
        let same_island =
            before.is_some_and(|before| (before.stage, before.island) == (run.stage, run.island));
        match islands_begun.insert((run.stage, run.island), run.rank) {
            Some(rank) if rank > run.rank => return Err(Fault::Precedence { step, item }),
            Some(_) if problem.scope == Scope::Island && !same_island => {
                return Err(Fault::Interrupted { step, item });
            }
            _ => {}
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::{Item, Run, Shape};
    use super::*;
    use pathwright_geometry::Point;

    /// Two islands of two runs with one short path each, after a skirt.
    fn problem(scope: Scope) -> Problem<'static> {
        let run = |stage, island, rank| Run { stage, island, layer: 0, rank };
        let runs = vec![run(0, u32::MAX, 0), run(1, 0, 0), run(1, 0, 1), run(1, 1, 0), run(1, 1, 1)];
        let item = |run: u32| Item {
            run,
            shape: Shape::Open([Point::new(run as i32, 0), Point::new(run as i32, 9)]),
        };
        Problem { items: (0..5).map(item).collect(), runs, scope, start: None, end: None }
    }

    fn verdict(scope: Scope, order: &[u32]) -> Result<(), Fault> {
        let sequence: Vec<_> = order.iter().map(|&item| Visit { item, entry: 0 }).collect();
        check(&problem(scope), &sequence)
    }

    #[test]
    fn the_skirt_comes_first_under_every_scope() {
        for (_, scope) in Scope::ALL {
            assert_eq!(verdict(*scope, &[0, 1, 2, 3, 4]), Ok(()));
            assert!(matches!(verdict(*scope, &[1, 0, 2, 3, 4]), Err(Fault::Precedence { step: 1, .. })));
        }
    }

    #[test]
    fn ranks_bind_except_at_layer_scope() {
        assert_eq!(verdict(Scope::Layer, &[0, 2, 1, 3, 4]), Ok(()));
        assert!(matches!(verdict(Scope::Feature, &[0, 2, 1, 3, 4]), Err(Fault::Precedence { .. })));
    }

    #[test]
    fn islands_interleave_except_at_island_scope() {
        assert_eq!(verdict(Scope::Feature, &[0, 1, 3, 2, 4]), Ok(()));
        assert!(matches!(verdict(Scope::Island, &[0, 1, 3, 2, 4]), Err(Fault::Interrupted { step: 3, .. })));
    }

    #[test]
    fn an_interrupted_run_is_found() {
        let mut problem = problem(Scope::Feature);
        problem.items[3].run = 1;
        problem.items[4].run = 2;
        problem.runs.truncate(3);
        let order = |order: [u32; 5]| order.map(|item| Visit { item, entry: 0 });
        assert_eq!(check(&problem, &order([0, 1, 3, 2, 4])), Ok(()));
        assert!(matches!(check(&problem, &order([0, 1, 2, 3, 4])), Err(Fault::Interrupted { .. })));
    }

    #[test]
    fn missing_repeated_and_unknown_paths_are_found() {
        assert!(matches!(verdict(Scope::Layer, &[0, 1, 2, 3]), Err(Fault::Missing { item: 4 })));
        assert!(matches!(verdict(Scope::Layer, &[0, 1, 2, 3, 3]), Err(Fault::Twice { step: 4, item: 3 })));
        assert!(matches!(verdict(Scope::Layer, &[0, 1, 2, 3, 9]), Err(Fault::NoSuchItem { item: 9, .. })));
    }
}
