//! Multi-fragment: the shortest link first.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::index::{Entry, Index};
use super::nearest::walk_groups;
use super::precedence::Groups;
use super::{Cost, Problem, Sequence, Shape, Strategy, Visit};
use crate::geom::Point;
use crate::profile::Effort;

/// Vertices of a loop from which links to other loops are looked for while neither has its entry; links between
/// a loop and anything else consider all vertices.
const LOOP_SAMPLES: usize = 4;

/// Joins paths into fragments by the shortest link that is still possible, until one fragment is left. A loop's
/// entry is settled by the first link that reaches it.
///
/// Groups (see [`Groups`]) are taken nearest first, and each is joined on its own, the nozzle's position being a
/// fragment too. Shortest in length is shortest in any [`Cost`]. Bentley 1992, "Fast algorithms for geometric
/// traveling salesman problems", doi:10.1287/ijoc.4.4.387. O(n log n) in practice.
#[derive(Clone, Copy, Debug)]
pub struct Greedy;

impl Strategy for Greedy {
    fn solve(&self, problem: &Problem, _: &Cost, _: Effort) -> Sequence {
        let groups = Groups::new(problem);
        let mut index = Index::new(problem, &groups);
        let mut fragments = Fragments::new(problem);
        walk_groups(problem, &groups, &mut index, |group, start, index, sequence| {
            fragments.join(group, &groups.items[group as usize], start, index);
            fragments.walk(&groups.items[group as usize], sequence);
        })
    }
}

/// No node.
const NONE: u32 = u32::MAX;

/// Fragments under construction. Item i has the nodes 2i and 2i + 1: its ends (at entry 0 and 1); a loop's
/// nodes both stand for the vertex where it is entered. The last node is the nozzle.
struct Fragments<'a> {
    problem: &'a Problem<'a>,
    /// The node linked to each node.
    link: Vec<u32>,
    /// The other end of the fragment, for nodes that end one.
    other_end: Vec<u32>,
    /// Entry of each loop that has a link.
    settled: Vec<Option<u32>>,
    nozzle: u32,
}

/// A possible link: from a node (of a loop: at an entry) to an entry of an item.
type Link = Reverse<(i64, u32, u32, u32, u32)>;

impl<'a> Fragments<'a> {
    fn new(problem: &'a Problem<'a>) -> Self {
        let items = problem.items.len();
        let nozzle = 2 * items as u32;
        Self {
            problem,
            link: vec![NONE; 2 * items + 1],
            other_end: (0..nozzle).map(|node| node ^ 1).chain([nozzle]).collect(),
            settled: vec![None; items],
            nozzle,
        }
    }

    /// Joins all items of a group, beginning at the nozzle, and removes them from the index.
    fn join(&mut self, group: u32, items: &[u32], start: Point, index: &mut Index) {
        self.link[self.nozzle as usize] = NONE;
        self.other_end[self.nozzle as usize] = self.nozzle;
        let nodes = items.iter().flat_map(|&item| [2 * item, 2 * item + 1]);
        let mut links: BinaryHeap<Link> = BinaryHeap::with_capacity(2 * items.len() + 1);
        for node in nodes.chain([self.nozzle]) {
            // A loop looks for links once, from its even node.
            if node % 2 == 0 || !self.is_loop(node) {
                links.extend(self.best_link(group, node, start, index));
            }
        }
        let mut missing = items.len();
        while missing > 0 {
            let Some(Reverse((_, from, from_entry, item, entry))) = links.pop() else { break };
            let from_item = from / 2;
            let from =
                if self.is_loop(from) { self.free_node(from_item, from_entry) } else { self.free(from) };
            let Some(from) = from else { continue };
            let to = self.free_node(item, entry).filter(|&to| self.other_end[from as usize] != to);
            let Some(to) = to else {
                links.extend(self.best_link(group, from, start, index));
                continue;
            };
            self.connect(from, from_entry, to, entry, index);
            missing -= 1;
            for node in [from, to] {
                // The loop's other node is still free, and now it has one entry only.
                if self.is_loop(node) && self.link[node as usize ^ 1] == NONE {
                    links.extend(self.best_link(group, node ^ 1, start, index));
                }
            }
        }
    }

    fn is_loop(&self, node: u32) -> bool {
        node != self.nozzle && matches!(self.problem.items[node as usize / 2].shape, Shape::Loop(_))
    }

    fn free(&self, node: u32) -> Option<u32> {
        (self.link[node as usize] == NONE).then_some(node)
    }

    /// The node that a link to an entry of an item would take.
    fn free_node(&self, item: u32, entry: u32) -> Option<u32> {
        match self.problem.items[item as usize].shape {
            Shape::Open(_) => self.free(2 * item + entry),
            Shape::Loop(_) if self.settled[item as usize].is_some_and(|settled| settled != entry) => None,
            Shape::Loop(_) => self.free(2 * item).or_else(|| self.free(2 * item + 1)),
        }
    }

    fn connect(&mut self, from: u32, from_entry: u32, to: u32, to_entry: u32, index: &mut Index) {
        self.link[from as usize] = to;
        self.link[to as usize] = from;
        let (a, b) = (self.other_end[from as usize], self.other_end[to as usize]);
        self.other_end[a as usize] = b;
        self.other_end[b as usize] = a;
        for (node, entry) in
            [(from, from_entry), (to, to_entry)].into_iter().filter(|&(n, _)| n != self.nozzle)
        {
            if self.is_loop(node) {
                self.settled[node as usize / 2] = Some(entry);
            }
            if self.link[node as usize ^ 1] != NONE {
                index.remove(node / 2);
            }
        }
    }

    /// The shortest possible link from a node to another fragment.
    fn best_link(&self, group: u32, node: u32, start: Point, index: &Index) -> Option<Link> {
        let other = self.other_end[node as usize];
        let possible = |entry: &Entry| {
            let to = self.free_node(entry.item, entry.entry);
            to.is_some_and(|to| to != other)
        };
        let search = |from: Point, from_entry: u32| {
            let to = index.nearest_in(group, from, Some(node / 2), possible)?;
            Some(Reverse((to.distance2, node, from_entry, to.item, to.entry)))
        };
        if node == self.nozzle {
            return search(start, 0);
        }
        match self.problem.items[node as usize / 2].shape {
            Shape::Open(ends) => search(ends[node as usize % 2], node % 2),
            Shape::Loop(vertices) => match self.settled[node as usize / 2] {
                Some(entry) => search(vertices[entry as usize], entry),
                None => {
                    let step = vertices.len().div_ceil(LOOP_SAMPLES);
                    let samples = (0..vertices.len()).step_by(step);
                    samples.filter_map(|entry| search(vertices[entry], entry as u32)).max()
                }
            },
        }
    }

    /// Appends the fragment that begins at the nozzle.
    fn walk(&mut self, items: &[u32], sequence: &mut Sequence) {
        let mut node = self.link[self.nozzle as usize];
        for _ in items {
            if node == NONE {
                return;
            }
            let item = node / 2;
            let entry = self.settled[item as usize].unwrap_or(node % 2);
            sequence.push(Visit { item, entry });
            node = self.link[node as usize ^ 1];
        }
    }
}
