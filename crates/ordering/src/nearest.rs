//! Nearest reachable end next: what most slicers do.

use super::index::Index;
use super::options::Effort;
use super::precedence::{Frontier, Groups};
use super::{Cost, Problem, Sequence, Strategy, Visit};
use pathwright_geometry::Point;

/// From where the nozzle is, always on to the nearest position where a path can be entered that may come next:
/// an end of an open path, an allowed vertex of a loop. Nothing known of the start: the first path as made.
///
/// Nearest in length is nearest in any [`Cost`]. O(n log n) in practice. In the worst case Θ(log n) times the
/// optimum for a metric (Rosenkrantz, Stearns & Lewis 1977, doi:10.1137/0206041).
#[derive(Clone, Copy, Debug)]
pub struct Nearest;

impl Strategy for Nearest {
    fn solve(&self, problem: &Problem, _: &Cost, _: Effort) -> Sequence {
        let groups = Groups::new(problem);
        Self::walk(problem, Frontier::new(&groups), problem.start, &mut Index::new(problem, &groups))
    }
}

impl Nearest {
    /// From a place through the groups of a frontier, all of whose items are in the index.
    pub(super) fn walk(
        problem: &Problem,
        frontier: (Frontier<'_>, Vec<u32>),
        from: Option<Point>,
        index: &mut Index,
    ) -> Sequence {
        walk_frontier(problem, frontier, from, index, |group, start, index, sequence| {
            let Some(first) = index.nearest_in(group, start, None, |_| true) else { return };
            let mut next = Some(first);
            while let Some(entry) = next {
                let visit = Visit { item: entry.item, entry: entry.entry };
                sequence.push(visit);
                index.remove(entry.item);
                let (_, at) = problem.items[entry.item as usize].ends(entry.entry);
                next = index.nearest_in(group, at, None, |_| true);
            }
        })
    }
}

/// Visits all groups, always the one with the nearest entry next, and lets `draw(group, from, index, sequence)`
/// append all items of that group; it may remove them from the index.
///
/// With no known start, the walk begins where the first path as made begins.
pub fn walk_groups(
    problem: &Problem,
    groups: &Groups,
    index: &mut Index,
    draw: impl FnMut(u32, Point, &mut Index, &mut Sequence),
) -> Sequence {
    walk_frontier(problem, Frontier::new(groups), problem.start, index, draw)
}

/// As [`walk_groups`], for the groups of a frontier.
fn walk_frontier(
    problem: &Problem,
    (mut frontier, mut released): (Frontier<'_>, Vec<u32>),
    from: Option<Point>,
    index: &mut Index,
    mut draw: impl FnMut(u32, Point, &mut Index, &mut Sequence),
) -> Sequence {
    let groups = frontier.groups;
    let first = |group: &u32| groups.items[*group as usize][0];
    let mut at = from.unwrap_or_else(|| {
        let item = released.iter().map(first).min();
        item.map_or(Point::default(), |item| problem.items[item as usize].ends(0).0)
    });
    let mut sequence = Sequence::new();
    let mut forced = None;
    loop {
        for group in released.drain(..).filter(|&group| forced != Some(group)) {
            index.open(group);
        }
        let group = match forced {
            Some(group) => group,
            None => {
                let Some(entry) = index.nearest_open(at) else { return sequence };
                let group = groups.of[entry.item as usize];
                index.close(group);
                group
            }
        };
        let drawn = sequence.len();
        draw(group, at, index, &mut sequence);
        sequence[drawn..].iter().for_each(|visit| index.remove(visit.item));
        if let Some(visit) = sequence.last() {
            at = problem.items[visit.item as usize].ends(visit.entry).1;
        }
        released = frontier.take(group);
        forced = if groups.whole_units { groups.next_in_unit(group) } else { None };
    }
}
