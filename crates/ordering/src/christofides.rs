//! Christofides' heuristic over print segments, as Fok, Ganganath, Cheng and Tse adapted it to 3D printing in 2016.

use super::entries::enter_shortest;
use super::index::Index;
use super::matching::{delaunay, euclidean};
use super::nearest::walk_groups;
use super::options::Effort;
use super::precedence::Groups;
use super::{Cost, Problem, Sequence, Shape, Strategy, Visit};
use pathwright_geometry::DisjointSets;
use pathwright_geometry::Point;

/// The algorithm of the 2016 paper: spanning tree over the print segments, exact matching of its odd nodes, Eulerian circuit,
/// cut at the start, shortcuts.
///
/// Every path is an edge of the graph from the outset, and Kruskal joins what they leave apart by shortest links. The
/// nozzle's position is a node, joined to itself by a virtual segment, which leaves all parities alone; the circuit begins
/// there and the return to it is dropped. What lies between two paths in the circuit is one straight travel.
///
/// A closed path is a node that is joined to itself, as the start is: it is entered and left at one vertex, at first the one that
/// the shortest link of a spanning tree over all vertices touches. (As a circuit of all its vertices a loop would seem to carry
/// the walk from one to another for free, yet it is drawn at once when it is met: that made links half as long again.)
///
/// Where the paper leaves a choice, the shortest of few is taken. The circuit is cut at any link and walked in either direction, whatever
/// makes the walk from the start shortest, and its edges can be taken in one of two orders. A loop that the circuit meets several times is drawn where that is the shortest detour. Once the
/// order stands, entries are chosen together, by dynamic programming along the tour; then loops are settled there, and the
/// algorithm runs again, for as long as that helps and at most three times.
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

/// How often the loops are settled again where the last tour enters them.
const ROUNDS: usize = 3;

pub(super) fn solve(problem: &Problem, ending: Ending) -> Sequence {
    let groups = Groups::new(problem);
    let mut index = Index::new(problem, &groups);
    let mut sequence = walk_groups(problem, &groups, &mut index, |group, start, _, sequence| {
        let items = &groups.items[group as usize];
        let last = sequence.len() + items.len() == problem.items.len();
        let end = problem.end.filter(|_| last);
        sequence.extend(solve_group(problem, items, start, end, ending));
    });
    // Once more, now that it is known where each run leads to.
    enter_shortest(problem, problem.start, problem.end, &mut sequence);
    sequence
}

/// The best of a few tours, each with the loops settled where the one before entered them.
fn solve_group(
    problem: &Problem,
    items: &[u32],
    start: Point,
    end: Option<Point>,
    ending: Ending,
) -> Sequence {
    let mut network = Network::new(problem, items, start, end.filter(|_| ending == Ending::Open));
    network.settle_loops();
    let length = |tour: &Sequence| length_mm(problem, start, end, tour);
    let mut best = Sequence::new();
    for round in 0..ROUNDS {
        let mut tour = network.tour(ending, end);
        enter_shortest(problem, Some(start), end, &mut tour);
        if round > 0 && length(&tour) >= length(&best) {
            break;
        }
        network.settle_at(&tour);
        best = tour;
    }
    best
}

/// Length of the links of a tour.
fn length_mm(problem: &Problem, start: Point, end: Option<Point>, tour: &[Visit]) -> f64 {
    let (mut at, mut total) = (start, 0.0);
    for visit in tour {
        let (enter, leave) = problem.items[visit.item as usize].ends(visit.entry);
        total += at.distance_mm(enter);
        at = leave;
    }
    total + end.map_or(0.0, |end| at.distance_mm(end))
}

/// The start is node 0.
const START: u32 = 0;

/// The meaning of an edge of the multigraph.
#[derive(Clone, Copy, PartialEq, Eq)]
enum EdgeKind {
    /// A travel.
    Travel,
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
    edges: Vec<(u32, u32, EdgeKind)>,
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
                    edges.push((node, node + 1, EdgeKind::Draw(item)));
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
                let slot = &mut settled[self.owner(node)];
                kept[node as usize] |= !std::mem::replace(slot, true);
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
        let mut parts = DisjointSets::new(self.nodes.len());
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
    fn make_even(&self, edges: &mut Vec<(u32, u32, EdgeKind)>, ending: Ending) {
        let mut odd = vec![false; self.nodes.len()];
        for &(u, v, _) in edges.iter() {
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
                edges.push((odd[v], odd[mate as usize], EdgeKind::Travel));
            }
        }
    }

    /// Settles each loop at the vertex where a tour enters it.
    fn settle_at(&mut self, tour: &[Visit]) {
        for visit in tour {
            if let (Some(at), Shape::Loop(vertices)) =
                (self.items.binary_search(&visit.item).ok(), self.problem.items[visit.item as usize].shape)
            {
                let node = &mut self.nodes[self.first[at] as usize];
                (node.entry, node.at) = (visit.entry, vertices[visit.entry as usize]);
            }
        }
    }

    /// The shortest of the tours that the multigraph's Eulerian walks become: edges are taken in one of two orders at each node,
    /// and a circuit is cut on either side of the start.
    fn tour(&self, ending: Ending, end: Option<Point>) -> Sequence {
        let mut edges = self.edges.clone();
        edges.extend(self.spanning_tree().into_iter().map(|(u, v)| (u, v, EdgeKind::Travel)));
        self.make_even(&mut edges, ending);
        let start = self.nodes[START as usize].at;
        let mut best = (f64::INFINITY, Sequence::new());
        for _ in 0..2 {
            let mut tour = self.shortcut(&self.eulerian(&edges));
            if ending == Ending::AtStart {
                self.cut(&mut tour, start, end);
            }
            let length = length_mm(self.problem, start, end, &tour);
            if length < best.0 {
                best = (length, tour);
            }
            edges.reverse();
        }
        best.1
    }

    /// Cuts a circuit at the link without which the walk from the start is shortest, and turns it round if that is shorter. The
    /// start itself is passed by, unless the cut is there.
    fn cut(&self, tour: &mut Sequence, start: Point, end: Option<Point>) {
        let count = tour.len();
        let ends =
            |at: usize| self.problem.items[tour[at % count].item as usize].ends(tour[at % count].entry);
        let to_end = |from: Point| end.map_or(0.0, |end| from.distance_mm(end));
        let mut best = (f64::INFINITY, 0, false);
        for at in 0..count {
            let (before, after) = (ends(at + count - 1).1, ends(at).0);
            let saved = before.distance_mm(after);
            let forth = start.distance_mm(after) + to_end(before) - saved;
            let back = start.distance_mm(before) + to_end(after) - saved;
            for (added, turned) in [(forth, false), (back, true)] {
                if added < best.0 {
                    best = (added, at, turned);
                }
            }
        }
        tour.rotate_left(best.1);
        if best.2 {
            tour.reverse();
            for visit in tour {
                if matches!(self.problem.items[visit.item as usize].shape, Shape::Open(_)) {
                    visit.entry = 1 - visit.entry;
                }
            }
        }
    }

    /// Draws every path where the walk does, and every loop at the one of its visits that is the shortest detour.
    fn shortcut(&self, walk: &[(u32, EdgeKind)]) -> Sequence {
        let open = |item: u32| matches!(self.problem.items[item as usize].shape, Shape::Open(_));
        let mut stops: Vec<Visit> = Vec::with_capacity(self.items.len());
        for &(node, kind) in walk {
            let Node { item, entry, .. } = self.nodes[node as usize];
            match kind {
                // The walk arrives at the other end of the path it draws.
                EdgeKind::Draw(item) => stops.push(Visit { item, entry: 1 - entry }),
                EdgeKind::Travel if item != u32::MAX && !open(item) => stops.push(Visit { item, entry }),
                EdgeKind::Travel => {}
            }
        }
        let mut visits = vec![Vec::new(); self.first.len()];
        for (stop, visit) in (1_u32..).zip(&stops) {
            if let Ok(at) = self.items.binary_search(&visit.item) {
                visits[at].push(stop);
            }
        }
        // Stops as a list in which those that are left out can be skipped; 0 is the start.
        let start = self.nodes[START as usize].at;
        let ends = |stop: u32| match stop.checked_sub(1).and_then(|stop| stops.get(stop as usize)) {
            Some(visit) => self.problem.items[visit.item as usize].ends(visit.entry),
            None => (start, start),
        };
        let past = stops.len() as u32 + 1;
        let mut before: Vec<u32> = (0..=past).map(|stop| stop.saturating_sub(1)).collect();
        let mut after: Vec<u32> = (1..=past + 1).collect();
        let mut left_out = vec![false; stops.len() + 2];
        for visits in visits.iter().filter(|visits| visits.len() > 1) {
            let detour = |stop: u32, before: &[u32], after: &[u32]| {
                let (from, at) = (ends(before[stop as usize]).1, ends(stop).0);
                let to = after[stop as usize];
                if to == past {
                    return from.distance_mm(at);
                }
                let to = ends(to).0;
                from.distance_mm(at) + at.distance_mm(to) - from.distance_mm(to)
            };
            let shortest = visits
                .iter()
                .map(|&stop| (detour(stop, &before, &after), stop))
                .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            for &stop in visits.iter().filter(|&&stop| shortest.is_none_or(|(_, kept)| kept != stop)) {
                let (from, to) = (before[stop as usize], after[stop as usize]);
                (after[from as usize], before[to as usize]) = (to, from);
                left_out[stop as usize] = true;
            }
        }
        (1_u32..)
            .zip(stops.iter())
            .filter(|(stop, _)| !left_out[*stop as usize])
            .map(|(_, &visit)| visit)
            .collect()
    }

    /// The nodes of an Eulerian walk from the start, each with the edge that leads to it. Hierholzer 1873,
    /// <https://doi.org/10.1007/BF01442866>.
    fn eulerian(&self, edges: &[(u32, u32, EdgeKind)]) -> Vec<(u32, EdgeKind)> {
        let mut rows = vec![0_u32; self.nodes.len() + 2];
        for &(u, v, _) in edges {
            rows[u as usize + 2] += 1;
            rows[v as usize + 2] += 1;
        }
        for i in 2..rows.len() {
            rows[i] += rows[i - 1];
        }
        let mut incident = vec![0_u32; 2 * edges.len()];
        for (e, &(u, v, _)) in edges.iter().enumerate() {
            for node in [u, v] {
                let slot = &mut rows[node as usize + 1];
                incident[*slot as usize] = e as u32;
                *slot += 1;
            }
        }
        let mut next: Vec<u32> = rows[..self.nodes.len()].to_vec();
        let mut used = vec![false; edges.len()];
        let mut stack = vec![(START, EdgeKind::Travel)];
        let mut walk = Vec::with_capacity(edges.len() + 1);
        while let Some(&(node, kind)) = stack.last() {
            let slot = &mut next[node as usize];
            if *slot == rows[node as usize + 1] {
                walk.push((node, kind));
                stack.pop();
                continue;
            }
            let e = incident[*slot as usize];
            *slot += 1;
            if !std::mem::replace(&mut used[e as usize], true) {
                let (u, v, kind) = edges[e as usize];
                stack.push((u ^ v ^ node, kind));
            }
        }
        // The walk comes out backwards.
        walk.reverse();
        walk
    }
}
