//! Multi-fragment: the shortest link first.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::entries::samples;
use super::index::{Entry, Index};
use super::nearest::walk_groups;
use super::options::Effort;
use super::precedence::Groups;
use super::{Cost, Problem, Sequence, Shape, Strategy, Visit};
use pathwright_geometry::Point;

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
            let items = &groups.items[group as usize];
            fragments.join(items, &mut InIndex { group, start, index });
            fragments.walk(items, sequence);
        })
    }
}

/// No node.
const NONE: u32 = u32::MAX;

/// Fragments under construction. Item i has the nodes 2i and 2i + 1: its ends (at entry 0 and 1); a loop's
/// nodes both stand for the vertex where it is entered. The last node is the nozzle.
#[derive(Debug)]
pub(super) struct Fragments<'a> {
    problem: &'a Problem<'a>,
    /// The node linked to each node.
    link: Vec<u32>,
    /// The other end of the fragment, for nodes that end one.
    other_end: Vec<u32>,
    /// Entry of each loop that has a link.
    settled: Vec<Option<u32>>,
    nozzle: u32,
}

/// A possible link: its squared length (square units), from a node (of a loop: at an entry), to an entry of an item.
pub(super) type Link = Reverse<(i64, u32, u32, u32, u32)>;

/// Where links come from.
pub(super) trait Links {
    /// The shortest link that is possible from a node to another fragment.
    fn shortest(&mut self, fragments: &Fragments, node: u32) -> Option<Link>;

    /// No link to an item is possible any more.
    fn done(&mut self, _item: u32) {}
}

impl<'a> Fragments<'a> {
    /// Every path is one.
    pub(super) fn new(problem: &'a Problem<'a>) -> Self {
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

    /// Joins all items of a group, beginning at the nozzle.
    pub(super) fn join(&mut self, items: &[u32], links: &mut impl Links) {
        self.link[self.nozzle as usize] = NONE;
        self.other_end[self.nozzle as usize] = self.nozzle;
        let nodes = items.iter().flat_map(|&item| [2 * item, 2 * item + 1]);
        let mut heap: BinaryHeap<Link> = BinaryHeap::with_capacity(2 * items.len() + 1);
        for node in nodes.chain([self.nozzle]) {
            // A loop looks for links once, from its even node.
            if node % 2 == 0 || !self.is_loop(node) {
                heap.extend(links.shortest(self, node));
            }
        }
        let mut missing = items.len();
        while missing > 0 {
            let Some(Reverse((_, from, from_entry, item, entry))) = heap.pop() else { break };
            let from_item = from / 2;
            let from =
                if self.is_loop(from) { self.free_node(from_item, from_entry) } else { self.free(from) };
            let Some(from) = from else { continue };
            let to = self.free_node(item, entry).filter(|&to| self.other_end[from as usize] != to);
            let Some(to) = to else {
                heap.extend(links.shortest(self, from));
                continue;
            };
            self.connect(from, from_entry, to, entry, links);
            missing -= 1;
            for node in [from, to] {
                // The loop's other node is still free, and now it has one entry only.
                if self.is_loop(node) && self.link[node as usize ^ 1] == NONE {
                    heap.extend(links.shortest(self, node ^ 1));
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

    fn connect(&mut self, from: u32, from_entry: u32, to: u32, to_entry: u32, links: &mut impl Links) {
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
                links.done(node / 2);
            }
        }
    }

    /// Whether a node could be linked to an entry of an item of another fragment.
    pub(super) fn permits(&self, node: u32, item: u32, entry: u32) -> bool {
        self.free_node(item, entry).is_some_and(|to| to != self.other_end[node as usize])
    }

    /// The item of a node; none for the nozzle.
    pub(super) fn item(&self, node: u32) -> Option<u32> {
        (node != self.nozzle).then_some(node / 2)
    }

    /// Entries of an item from which a node can be linked: of a loop whose entry is not settled, some of its vertices.
    pub(super) fn entries(&self, node: u32) -> impl Iterator<Item = u32> + use<> {
        let settled = self.settled[node as usize / 2];
        let (first, vertices) = match self.problem.items[node as usize / 2].shape {
            Shape::Open(_) => (node % 2, 1),
            Shape::Loop(vertices) => settled.map_or((0, vertices.len()), |entry| (entry, 1)),
        };
        samples(vertices, true).map(move |entry| first + entry)
    }

    /// Appends the fragment that begins at the nozzle.
    pub(super) fn walk(&self, items: &[u32], sequence: &mut Sequence) {
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

/// Links to the entries of one group.
struct InIndex<'i, 'a> {
    group: u32,
    start: Point,
    index: &'i mut Index<'a>,
}

impl Links for InIndex<'_, '_> {
    fn shortest(&mut self, fragments: &Fragments, node: u32) -> Option<Link> {
        let item = fragments.item(node);
        let possible = |entry: &Entry| fragments.permits(node, entry.item, entry.entry);
        let search = |from: Point, from_entry: u32| {
            let to = self.index.nearest_in(self.group, from, item, possible)?;
            Some(Reverse((to.distance2, node, from_entry, to.item, to.entry)))
        };
        let Some(item) = item else { return search(self.start, 0) };
        let ends = |entry| fragments.problem.items[item as usize].ends(entry).0;
        fragments.entries(node).filter_map(|entry| search(ends(entry), entry)).max()
    }

    fn done(&mut self, item: u32) {
        self.index.remove(item);
    }
}
