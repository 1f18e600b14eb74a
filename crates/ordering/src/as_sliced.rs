//! As the toolpath stage made them.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::options::Effort;
use super::precedence::{Frontier, Groups};
use super::{Cost, Problem, Sequence, Strategy, Visit};

/// Paths in the order and direction in which they were made, as far as precedence lets them: always the
/// lowest index that may come next. Loops are entered at their first vertex. O(n log n).
#[derive(Clone, Copy, Debug)]
pub struct AsSliced;

impl Strategy for AsSliced {
    fn solve(&self, problem: &Problem, _: &Cost, _: Effort) -> Sequence {
        let groups = Groups::new(problem);
        let (mut frontier, available) = Frontier::new(&groups);
        let keyed = |group: u32| Reverse((groups.items[group as usize][0], group));
        let mut open: BinaryHeap<_> = available.into_iter().map(keyed).collect();
        let mut next = None;
        let mut sequence = Sequence::with_capacity(problem.items.len());
        while let Some(group) = next.take().or_else(|| open.pop().map(|Reverse((_, group))| group)) {
            sequence.extend(groups.items[group as usize].iter().map(|&item| Visit { item, entry: 0 }));
            let released = frontier.take(group);
            if groups.whole_units {
                next = groups.next_in_unit(group);
            }
            open.extend(released.into_iter().filter(|&group| next != Some(group)).map(keyed));
        }
        sequence
    }
}
