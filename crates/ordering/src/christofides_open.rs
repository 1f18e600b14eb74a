//! Christofides' heuristic without the return to the start.

use super::christofides::{Ending, solve};
use super::options::Effort;
use super::{Cost, Problem, Sequence, Strategy};

/// As [`super::Christofides`], but the walk need not return: the start becomes one end of the Eulerian walk, and the
/// matching leaves one odd node free, whichever saves most, to be the other. Where the end is known, both are fixed.
///
/// Hoogeveen 1991, <https://doi.org/10.1016/0167-6377(91)90016-I>.
#[derive(Clone, Copy, Debug)]
pub struct ChristofidesOpen;

impl Strategy for ChristofidesOpen {
    fn solve(&self, problem: &Problem, _: &Cost, _: Effort) -> Sequence {
        solve(problem, Ending::Open)
    }
}
