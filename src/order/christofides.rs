//! Christofides' heuristic over print segments, as Fok, Ganganath, Cheng and Tse adapted it to 3D printing in 2016.

use super::index::Index;
use super::matching::{delaunay, euclidean};
use super::nearest::walk_groups;
use super::parts::Parts;
use super::precedence::Groups;
use super::{Cost, Problem, Sequence, Shape, Strategy, Visit};
use crate::geom::Point;
use crate::profile::Effort;

/// The seed's algorithm: spanning tree over the print segments, exact matching of its odd nodes, Eulerian circuit,
/// cut at the start, shortcuts.
///
/// Every path is an edge of the graph from the outset, and Kruskal joins what they leave apart by shortest links. The
/// nozzle's position is a node, joined to itself by a virtual segment, which leaves all parities alone; the circuit begins
/// there and its way back is dropped. What lies between two paths in the circuit is one straight travel.
///
/// A closed path is a node that is joined to itself, as the start is: it is entered and left at one vertex, the one that
/// the shortest link of a spanning tree over all vertices touches. (The paper leaves this open. As a circuit of all
/// its vertices a loop would seem to carry the walk from one to another for free, yet it is drawn at once when it is met:
/// that made links half as long again.) Once the order stands, each loop moves its seam to the vertex with the shortest
/// way from the path before and to the path after.
///
/// Under `feature` and `island` scope the algorithm orders each run, and the runs follow each other by nearest entry.
/// Links are measured by length whatever the cost: matching needs a metric, which time with retraction is not.
///
/// K.-Y. Fok, N. Ganganath, C.-T. Cheng, C. K. Tse, "A 3D printing path optimizer based on Christofides algorithm", IEEE
/// ICCE-TW 2016. What it guarantees and what not: `docs/ordering-bounds.md`. O(n log n) in practice.
#[derive(Clone, Copy, Debug)]
pub struct Christofides;

impl Strategy for Christofides {
    fn solve(&self, problem: &Problem, _: &Cost, _: Effort) -> Sequence {
        solve(problem, Ending::AtStart)
    }
}

/// Where the Eulerian walk ends.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Ending {
    /// Where it began.
    AtStart,
    /// At the problem's end; anywhere if there is none.
    Open,
}

pub(super) fn solve(problem: &Problem, ending: Ending) -> Sequence {
    let groups = Groups::new(problem);
    let mut index = Index::new(problem, &groups);
    let mut sequence = walk_groups(problem, &groups, &mut index, |group, start, _, sequence| {
        let items = &groups.items[group as usize];
        let last = sequence.len() + items.len() == problem.items.len();
        let end = problem.end.filter(|_| last && ending == Ending::Open);
        let mut network = Network::new(problem, items, start, end);
        network.settle_loops();
        let mut part = network.walk(ending);
        reseat(problem, Some(start), end, &mut part);
        sequence.extend(part);
    });
    // Once more, now that it is known where each run leads to.
    reseat(problem, problem.start, problem.end, &mut sequence);
    sequence
}

/// The start is node 0.
const START: u32 = 0;

/// What an edge of the multigraph stands for.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Way {
    /// A travel.
    Move,
    /// An open path, by index into the items; the direction is that of the walk.
    Draw(u32),
}

/// Where a node is.
#[derive(Clone, Copy)]
struct Node {
    at: Point,
    /// The item it belongs to; `u32::MAX`: start and end.
    item: u32,
    /// As in [`Visit`].
    entry: u32,
}

/// Ends, vertices and paths of one group as a multigraph.
struct Network<'a> {
    problem: &'a Problem<'a>,
    nodes: Vec<Node>,
    /// Each item's first node.
    first: Vec<u32>,
    items: &'a [u32],
    edges: Vec<(u32, u32, Way)>,
    /// Whether the last node is where the walk must end.
    fixed_end: bool,
}

impl<'a> Network<'a> {
    fn new(problem: &'a Problem<'a>, items: &'a [u32], start: Point, end: Option<Point>) -> Self {
        let mut nodes = vec![Node { at: start, item: u32::MAX, entry: 0 }];
        let mut first = Vec::with_capacity(items.len());
        let mut edges = Vec::new();
        for &item in items {
            let node = nodes.len() as u32;
            first.push(node);
            let vertices = match &problem.items[item as usize].shape {
                Shape::Open(ends) => {
                    edges.push((node, node + 1, Way::Draw(item)));
                    &ends[..]
                }
                Shape::Loop(vertices) => vertices,
            };
            nodes.extend(vertices.iter().zip(0..).map(|(&at, entry)| Node { at, item, entry }));
        }
        nodes.extend(end.map(|at| Node { at, item: u32::MAX, entry: 0 }));
        Self { problem, nodes, first, items, edges, fixed_end: end.is_some() }
    }

    /// Leaves each loop the one vertex that the shortest link of a spanning tree touches.
    fn settle_loops(&mut self) {
        let mut kept = vec![false; self.nodes.len()];
        let mut settled = vec![false; self.items.len() + 1];
        for (u, v) in self.spanning_tree() {
            for node in [u, v] {
                let place = &mut settled[self.owner(node)];
                kept[node as usize] |= !std::mem::replace(place, true);
            }
        }
        let open = |node: &Node| {
            node.item == u32::MAX || matches!(self.problem.items[node.item as usize].shape, Shape::Open(_))
        };
        let mut moved = vec![0; self.nodes.len()];
        let mut nodes = Vec::new();
        for (old, node) in self.nodes.iter().enumerate() {
            moved[old] = nodes.len() as u32;
            if kept[old] || open(node) {
                nodes.push(*node);
            }
        }
        self.nodes = nodes;
        for first in &mut self.first {
            *first = moved[*first as usize];
        }
        for (u, v, _) in &mut self.edges {
            (*u, *v) = (moved[*u as usize], moved[*v as usize]);
        }
    }

    /// Index into `items` of the path that a node belongs to; one past the last for start and end.
    fn owner(&self, node: u32) -> usize {
        if self.nodes[node as usize].item == u32::MAX {
            self.items.len()
        } else {
            self.first.partition_point(|&first| first <= node) - 1
        }
    }

    /// The shortest links that join everything, shortest first: Kruskal 1956 (<https://doi.org/10.1090/S0002-9939-1956-0078686-7>)
    /// over the paths, the Delaunay edges, and the coincident points.
    fn spanning_tree(&self) -> Vec<(u32, u32)> {
        let points: Vec<Point> = self.nodes.iter().map(|node| node.at).collect();
        let mut links: Vec<(i64, u32, u32)> = delaunay(&points)
            .into_iter()
            .map(|(u, v)| (points[u as usize].distance2(points[v as usize]), u, v))
            .collect();
        let mut by_place: Vec<u32> = (0..points.len() as u32).collect();
        by_place.sort_unstable_by_key(|&v| (points[v as usize], v));
        links.extend(by_place.windows(2).filter_map(|pair| {
            (points[pair[0] as usize] == points[pair[1] as usize]).then_some((0, pair[0], pair[1]))
        }));
        links.sort_unstable();
        let mut parts = Parts::new(self.nodes.len());
        for (k, &first) in self.first.iter().enumerate() {
            let last =
                self.first.get(k + 1).copied().unwrap_or(self.nodes.len() as u32 - u32::from(self.fixed_end));
            for node in first + 1..last {
                parts.join(first, node);
            }
        }
        links.into_iter().filter(|&(_, u, v)| parts.join(u, v)).map(|(_, u, v)| (u, v)).collect()
    }

    /// Adds the cheapest set of links that leaves an Eulerian walk with the given ending.
    fn make_even(&mut self, ending: Ending) {
        let mut odd = vec![false; self.nodes.len()];
        for &(u, v, _) in &self.edges {
            odd[u as usize] ^= true;
            odd[v as usize] ^= true;
        }
        if ending == Ending::Open {
            odd[START as usize] ^= true;
            let last = odd.len() - 1;
            odd[last] ^= self.fixed_end;
        }
        let odd: Vec<u32> = (0..odd.len() as u32).filter(|&v| odd[v as usize]).collect();
        let points: Vec<Point> = odd.iter().map(|&v| self.nodes[v as usize].at).collect();
        for (v, mate) in euclidean(&points).into_iter().enumerate() {
            if v < mate as usize {
                self.edges.push((odd[v], odd[mate as usize], Way::Move));
            }
        }
    }

    fn walk(mut self, ending: Ending) -> Sequence {
        let tree = self.spanning_tree();
        self.edges.extend(tree.into_iter().map(|(u, v)| (u, v, Way::Move)));
        self.make_even(ending);
        let mut drawn = vec![false; self.problem.items.len()];
        let mut sequence = Sequence::with_capacity(self.items.len());
        for (node, way) in self.eulerian() {
            let Node { item, entry, .. } = self.nodes[node as usize];
            let visit = match way {
                // The walk arrives at the other end of the path it draws.
                Way::Draw(item) => Visit { item, entry: 1 - entry },
                Way::Move => Visit { item, entry },
            };
            let open = |item: u32| matches!(self.problem.items[item as usize].shape, Shape::Open(_));
            if item != u32::MAX && !drawn[item as usize] && (way != Way::Move || !open(item)) {
                drawn[item as usize] = true;
                sequence.push(visit);
            }
        }
        sequence
    }

    /// The nodes of an Eulerian walk from the start, each with the edge that leads to it. Hierholzer 1873,
    /// <https://doi.org/10.1007/BF01442866>.
    fn eulerian(&self) -> Vec<(u32, Way)> {
        let mut rows = vec![0_u32; self.nodes.len() + 2];
        for &(u, v, _) in &self.edges {
            rows[u as usize + 2] += 1;
            rows[v as usize + 2] += 1;
        }
        for i in 2..rows.len() {
            rows[i] += rows[i - 1];
        }
        let mut incident = vec![0_u32; 2 * self.edges.len()];
        for (e, &(u, v, _)) in self.edges.iter().enumerate() {
            for node in [u, v] {
                let place = &mut rows[node as usize + 1];
                incident[*place as usize] = e as u32;
                *place += 1;
            }
        }
        let mut next: Vec<u32> = rows[..self.nodes.len()].to_vec();
        let mut used = vec![false; self.edges.len()];
        let mut stack = vec![(START, Way::Move)];
        let mut walk = Vec::with_capacity(self.edges.len() + 1);
        while let Some(&(node, way)) = stack.last() {
            let place = &mut next[node as usize];
            if *place == rows[node as usize + 1] {
                walk.push((node, way));
                stack.pop();
                continue;
            }
            let e = incident[*place as usize];
            *place += 1;
            if !std::mem::replace(&mut used[e as usize], true) {
                let (u, v, way) = self.edges[e as usize];
                stack.push((u ^ v ^ node, way));
            }
        }
        // The walk comes out backwards.
        walk.reverse();
        walk
    }
}

/// Moves each loop's seam to the vertex with the shortest way from the path before and to the path after, going on
/// until nothing moves or a few rounds are done.
fn reseat(problem: &Problem, start: Option<Point>, end: Option<Point>, sequence: &mut Sequence) {
    const ROUNDS: usize = 4;
    for _ in 0..ROUNDS {
        let mut moved = false;
        let mut before = start;
        for at in 0..sequence.len() {
            let after = match sequence.get(at + 1) {
                Some(next) => Some(problem.items[next.item as usize].ends(next.entry).0),
                None => end,
            };
            let visit = &mut sequence[at];
            let item = problem.items[visit.item as usize];
            if let Shape::Loop(vertices) = item.shape {
                let way =
                    |v: Point| [before, after].into_iter().flatten().map(|p| p.distance_mm(v)).sum::<f64>();
                let mut best = (way(vertices[visit.entry as usize]), visit.entry);
                for (&v, entry) in vertices.iter().zip(0..) {
                    let length = way(v);
                    if length < best.0 {
                        best = (length, entry);
                        moved = true;
                    }
                }
                visit.entry = best.1;
            }
            before = Some(item.ends(visit.entry).1);
        }
        if !moved {
            return;
        }
    }
}
