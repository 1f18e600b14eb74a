//! First solutions.

use std::cmp::Reverse;

use super::super::greedy::{Fragments, Link, Links};
use super::super::precedence::Groups;
use super::super::{Problem, Sequence};
use super::neighbours::{NEAR, Near, Neighbours};
use pathwright_geometry::Point;

/// A first solution for the groups of one stage, from where the nozzle is: fragments, joined shortest first.
pub fn start(
    problem: &Problem,
    groups: &Groups,
    stage: std::ops::Range<usize>,
    from: Option<Point>,
    neighbours: &mut Neighbours,
    fragments: &mut Fragments,
) -> Sequence {
    let mut sequence = Sequence::new();
    for group in stage {
        let items = &groups.items[group];
        let from = from.unwrap_or_else(|| problem.items[items[0] as usize].ends(0).0);
        let mut near = NearLists { problem, group: group as u32, from, neighbours };
        fragments.join(items, &mut near);
        fragments.walk(items, &mut sequence);
    }
    sequence
}

/// Links to what the lists of neighbours hold, and to anything in the group where they are exhausted.
struct NearLists<'s, 'a> {
    problem: &'s Problem<'a>,
    group: u32,
    from: Point,
    neighbours: &'s mut Neighbours,
}

impl Links for NearLists<'_, '_> {
    fn shortest(&mut self, fragments: &Fragments, node: u32) -> Option<Link> {
        let Some(item) = fragments.item(node) else { return self.search(fragments, node, self.from, 0) };
        let mut best: Option<Link> = None;
        for entry in fragments.entries(node) {
            let from = self.problem.items[item as usize].ends(entry).0;
            let list = self.neighbours.of(self.problem, self.group, item, entry);
            let permitted = (0..NEAR)
                .map(|at| self.neighbours.get(list, at))
                .take_while(|near| near.least.is_finite())
                .find(|near| fragments.permits(node, near.node / 2, near.entry));
            let link = match permitted {
                Some(Near { node: to, entry: to_entry, .. }) => {
                    let distance2 = self.problem.items[to as usize / 2].ends(to_entry).0.distance2(from);
                    Some(Reverse((distance2, node, entry, to / 2, to_entry)))
                }
                None => self.search(fragments, node, from, entry),
            };
            best = best.max(link);
        }
        best
    }
}

impl NearLists<'_, '_> {
    fn search(&self, fragments: &Fragments, node: u32, from: Point, from_entry: u32) -> Option<Link> {
        let own = fragments.item(node);
        let wanted = |to: u32, entry: u32| Some(to / 2) != own && fragments.permits(node, to / 2, entry);
        let (distance2, to, entry) = self.neighbours.nearest_wanted(self.group, from, wanted)?;
        Some(Reverse((distance2, node, from_entry, to / 2, entry)))
    }
}
