//! The walk under improvement, as an array.

use super::super::cost::{LinkCosts, Place};
use super::super::detours::Detours;
use super::super::precedence::Groups;
use super::super::{Cost, Item, LinkKind, Problem, Sequence, Shape, Visit};
use super::end::{End, GAIN, NONE};
use pathwright_geometry::Point;
use pathwright_geometry::real;

/// A walk through all items, with a journal of changes so that they can be undone.
///
/// Item i has the nodes 2i and 2i + 1, its ends at entry 0 and 1; both nodes of a loop lie where it is entered. Items n
/// and n + 1 are sentinels: where the nozzle is and where the next layer begins. Positions from 1 on hold
/// the items; gap g lies between the positions g − 1 and g.
#[derive(Debug)]
pub struct Walk<'a> {
    cost: LinkCosts,
    /// What links inside islands cost; `None`: as much as straight lines.
    detours: Option<&'a Detours<'a>>,
    /// The node at which the item at each position is entered; it is left at the other node, `^ 1`.
    entered: Vec<u32>,
    position: Vec<u32>,
    nodes: Vec<Node>,
    /// Which items are loops.
    looped: Vec<bool>,
    /// Vertices of all loops, and those of each item: `vertices[first_vertex[i]..first_vertex[i + 1]]`.
    vertices: Vec<[f64; 2]>,
    first_vertex: Vec<u32>,
    /// Where each loop is entered.
    entry: Vec<u32>,
    /// Where each item is.
    places: Vec<Place>,
    /// First position and length of each group.
    span: Vec<(u32, u32)>,
    journal: Vec<Change>,
    /// Cost of all links now, and when the journal was empty.
    total: f64,
    committed: f64,
    /// Elementary steps so far: link costs looked at and array cells written (in eighths).
    pub work: u64,
}

/// The data of a node that the search reads, side by side.
#[derive(Clone, Copy, Debug)]
struct Node {
    /// Where it is, millimetres; NaN: unknown, so that links to it cost nothing.
    at: [f64; 2],
    /// Cost of its link.
    link: f64,
    /// The node that it is linked to.
    across: u32,
    /// Group of its item; [`NONE`] for sentinels.
    group: u32,
}

#[derive(Clone, Copy, Debug)]
enum Change {
    Reversed(u32, u32),
    Entered { item: u32, before: u32 },
}

/// Island and layer of where the nozzle comes from; one less, of where it goes to: no path's.
const NOWHERE: u32 = u32::MAX - 1;

/// An unknown point: links to it cost nothing.
const ANYWHERE: [f64; 2] = [f64::NAN; 2];

fn coordinates(point: Option<Point>) -> [f64; 2] {
    point.map_or(ANYWHERE, Point::mm)
}

impl<'a> Walk<'a> {
    /// A walk from the start of a problem through nothing as yet, to anywhere.
    pub fn new(problem: &Problem, groups: &Groups, cost: Cost) -> Self {
        let n = problem.items.len();
        let mut points = Vec::with_capacity(2 * n + 4);
        let (mut all_vertices, mut first_vertex) = (Vec::new(), Vec::with_capacity(n + 3));
        for item in &problem.items {
            first_vertex.push(all_vertices.len() as u32);
            match item.shape {
                Shape::Open([a, b]) => points.extend([a.mm(), b.mm()]),
                Shape::Loop(vertices) => {
                    all_vertices.extend(vertices.iter().map(|v| v.mm()));
                    points.extend([vertices[0].mm(); 2]);
                }
            }
        }
        first_vertex.extend([all_vertices.len() as u32; 3]);
        points.extend([coordinates(problem.start), coordinates(problem.start), ANYWHERE, ANYWHERE]);
        let group = groups.of.iter().copied().chain([NONE, NONE]).flat_map(|group| [group, group]);
        let node = |(at, group)| Node { at, link: 0.0, across: 0, group };
        let place = |item: &Item| problem.runs[item.run as usize].place();
        let nowhere = [NOWHERE, NOWHERE - 1].map(|none| Place { island: none, layer: none });
        Self {
            cost: cost.into(),
            detours: None,
            entered: vec![2 * n as u32, 2 * n as u32 + 2],
            position: vec![0; n + 2],
            nodes: points.into_iter().zip(group).map(node).collect(),
            looped: first_vertex.windows(2).map(|w| w[0] < w[1]).collect(),
            vertices: all_vertices,
            first_vertex,
            entry: vec![0; n],
            places: problem.items.iter().map(place).chain(nowhere).collect(),
            span: groups.items.iter().map(|items| (0, items.len() as u32)).collect(),
            journal: Vec::new(),
            total: 0.0,
            committed: 0.0,
            work: 0,
        }
    }

    /// Goes on through more items: all those of some groups. Cannot be undone.
    pub fn append(&mut self, visits: &[Visit]) {
        let from = self.entered.len() as u32 - 1;
        let Some(end) = self.entered.pop() else { return };
        for &Visit { item, entry } in visits {
            self.position[item as usize] = self.entered.len() as u32;
            if self.is_loop(item) {
                self.entry[item as usize] = entry;
                self.put(item);
                self.entered.push(2 * item);
            } else {
                self.entered.push(2 * item + entry);
            }
        }
        self.entered.push(end);
        self.find_spans(from, self.len());
        self.total += (from..=self.len() + 1).map(|gap| self.relink(gap)).sum::<f64>();
        self.commit();
    }

    /// Makes links inside islands cost their route with detours instead of the straight line. Cannot be undone.
    pub fn use_detours(&mut self, detours: &'a Detours<'a>) {
        self.detours = Some(detours);
        self.total = (1..=self.len() + 1).map(|gap| self.relink(gap)).sum();
        self.commit();
    }

    /// Goes on to a point at the end.
    pub fn end_at(&mut self, end: Option<Point>) {
        let node = self.entered[self.entered.len() - 1] as usize;
        self.nodes[node..node + 2].iter_mut().for_each(|node| node.at = coordinates(end));
        self.total += self.relink(self.len() + 1);
        self.commit();
    }

    /// The solution as it is now.
    pub fn sequence(&self) -> Sequence {
        (1..=self.len()).map(|position| self.visit(position)).collect()
    }

    /// What is drawn at a position, and how.
    pub fn visit(&self, position: u32) -> Visit {
        let node = self.entered[position as usize];
        let item = node / 2;
        let entry = if self.is_loop(item) { self.entry[item as usize] } else { node % 2 };
        Visit { item, entry }
    }

    /// Number of items on the walk.
    #[inline]
    pub fn len(&self) -> u32 {
        self.entered.len() as u32 - 2
    }

    /// Whether an item is a loop. Sentinels are not.
    #[inline]
    pub fn is_loop(&self, item: u32) -> bool {
        self.looped[item as usize]
    }

    /// The nodes that a listed one stands for: both of a loop, or itself.
    #[inline]
    pub fn nodes_of(&self, node: u32) -> impl Iterator<Item = u32> + use<> {
        let count = 1 + u32::from(self.is_loop(node / 2));
        (0..count).map(move |other| node ^ other)
    }

    /// Where a loop may be entered, millimetres; nothing for open paths and sentinels.
    #[inline]
    pub fn vertices(&self, item: u32) -> Option<&[[f64; 2]]> {
        let (from, to) = (self.first_vertex[item as usize], self.first_vertex[item as usize + 1]);
        (from < to).then(|| &self.vertices[from as usize..to as usize])
    }

    /// Whether the walk is more expensive than at the last [`Self::commit`].
    pub fn is_worse(&self) -> bool {
        self.total > self.committed + 1e-9
    }

    /// Whether the walk costs what it did at the last [`Self::commit`].
    pub fn is_as_before(&self) -> bool {
        (self.total - self.committed).abs() <= 1e-9
    }

    /// Where a loop is entered.
    #[inline]
    pub fn entry(&self, item: u32) -> u32 {
        self.entry[item as usize]
    }

    /// The item at a position.
    #[inline]
    pub fn item_at(&self, position: u32) -> u32 {
        self.entered[position as usize] / 2
    }

    /// Position of an item.
    #[inline]
    pub fn position(&self, item: u32) -> u32 {
        self.position[item as usize]
    }

    /// Group of the item at a position; [`NONE`] for sentinels.
    #[inline]
    pub fn group_at(&self, position: u32) -> u32 {
        self.group_of(self.entered[position as usize])
    }

    /// Group of the item that a node belongs to; [`NONE`] for sentinels.
    #[inline]
    pub fn group_of(&self, node: u32) -> u32 {
        self.nodes[node as usize].group
    }

    /// Positions of a group's items, the last one excluded; also its first and last gap.
    #[inline]
    pub fn span(&self, group: u32) -> (u32, u32) {
        let (first, len) = self.span[group as usize];
        (first, first + len)
    }

    /// The node before or after a gap.
    #[inline]
    pub fn node(&self, end: End) -> u32 {
        if end.right { self.entered[end.gap as usize] } else { self.entered[end.gap as usize - 1] ^ 1 }
    }

    /// The node on the other side of a node's gap.
    #[inline]
    pub fn across(&self, node: u32) -> u32 {
        self.nodes[node as usize].across
    }

    /// The gap of an open path's node.
    #[inline]
    pub fn end_of(&self, node: u32) -> End {
        let at = self.position[node as usize / 2];
        if self.entered[at as usize] == node {
            End { gap: at, right: true }
        } else {
            End { gap: at + 1, right: false }
        }
    }

    /// What is minimised, of straight lines.
    pub fn cost(&self) -> &LinkCosts {
        &self.cost
    }

    /// Whether links may cost more than straight lines.
    #[inline]
    pub fn has_detours(&self) -> bool {
        self.detours.is_some()
    }

    /// Position of a node, millimetres.
    #[inline]
    pub fn point(&self, node: u32) -> [f64; 2] {
        self.nodes[node as usize].at
    }

    /// Cost of the link between two nodes if it went straight.
    #[inline]
    pub fn link(&self, a: u32, b: u32) -> f64 {
        self.between([a, b].map(|node| self.point(node)), [a / 2, b / 2])
    }

    /// Cost of the link between a node and a vertex of a loop if it went straight.
    #[inline]
    pub fn link_to(&self, node: u32, item: u32, vertex: [f64; 2]) -> f64 {
        self.between([self.point(node), vertex], [node / 2, item])
    }

    /// By how much the link between two nodes is more expensive than a straight one. Finding out takes long; a move that straight
    /// links would not make cheaper need not ask.
    #[inline]
    pub fn surcharge(&self, a: u32, b: u32) -> f64 {
        self.beyond_straight([a, b].map(|node| self.point(node)), [a / 2, b / 2])
    }

    /// By how much the link between a node and a vertex of a loop is more expensive than a straight one.
    #[inline]
    pub fn surcharge_to(&self, node: u32, item: u32, vertex: [f64; 2]) -> f64 {
        self.beyond_straight([self.point(node), vertex], [node / 2, item])
    }

    #[inline]
    fn beyond_straight(&self, points: [[f64; 2]; 2], items: [u32; 2]) -> f64 {
        let Some(detours) = self.detours else { return 0.0 };
        let straight = self.between(points, items);
        if straight <= 0.0 || !self.kind(items).inside {
            return 0.0;
        }
        detours.cost(items, points[0], points[1]) - straight
    }

    /// Cost of the straight link between points on two items; 0 if the position of either is free.
    #[inline]
    fn between(&self, [a, b]: [[f64; 2]; 2], items: [u32; 2]) -> f64 {
        let (dx, dy) = (a[0] - b[0], a[1] - b[1]);
        let square = dx * dx + dy * dy;
        // NaN: from or to an unknown point.
        match &self.cost {
            _ if square.is_nan() => 0.0,
            LinkCosts::Length => square.sqrt(),
            LinkCosts::Time(time) => time.of(square.sqrt(), self.kind(items)),
        }
    }

    /// Whether the link over a gap is more expensive than a straight one.
    pub fn is_expensive(&self, gap: u32) -> bool {
        let [left, right] = [false, true].map(|right| self.node(End { gap, right }));
        self.gap(gap) > self.link(left, right) + GAIN
    }

    /// What a link between two items leads over.
    #[inline]
    fn kind(&self, items: [u32; 2]) -> LinkKind {
        let [from, to] = items.map(|item| self.places[item as usize]);
        LinkKind::joining(from, to)
    }

    /// What the link over a gap leads over.
    pub fn kind_of(&self, gap: u32) -> LinkKind {
        self.kind([false, true].map(|right| self.node(End { gap, right }) / 2))
    }

    /// The vertex of a loop that is cheapest to visit between two nodes, and the cost of its two straight links.
    pub fn best_vertex(&self, item: u32, before: u32, after: u32) -> (f64, u32) {
        const AT_ONCE: usize = 8;
        let vertices = self.vertices(item).unwrap_or_default();
        let length_mm = |a: [f64; 2], b: [f64; 2]| {
            let (dx, dy) = (a[0] - b[0], a[1] - b[1]);
            // NaN, from or to an unknown point, becomes 0.
            real::greater((dx * dx + dy * dy).sqrt(), 0.0)
        };
        let [to_kind, from_kind] = [before, after].map(|node| self.kind([node / 2, item]));
        let (before, after) = (self.point(before), self.point(after));
        let mut best = (f64::INFINITY, 0);
        let mut lengths = [[0.0; 2]; AT_ONCE];
        for (some, first) in vertices.chunks(AT_ONCE).zip((0..).step_by(AT_ONCE)) {
            for (lengths, &vertex) in lengths.iter_mut().zip(some) {
                *lengths = [length_mm(before, vertex), length_mm(vertex, after)];
            }
            for ([to, from], entry) in lengths[..some.len()].iter().zip(first..) {
                let cost = self.cost.of(*to, to_kind) + self.cost.of(*from, from_kind);
                if cost < best.0 {
                    best = (cost, entry);
                }
            }
        }
        best
    }

    /// The least that a link from a point to anything in a disc can cost.
    #[inline]
    pub fn beyond(&self, point: [f64; 2], center: [f64; 2], radius: f64) -> f64 {
        let distance_mm = real::hypot(point[0] - center[0], point[1] - center[1]);
        if distance_mm > radius { self.cost.least(distance_mm - radius) } else { 0.0 }
    }

    /// Cost of the link at a node.
    #[inline]
    pub fn link_at(&self, node: u32) -> f64 {
        self.nodes[node as usize].link
    }

    /// Cost of the link over a gap.
    #[inline]
    pub fn gap(&self, gap: u32) -> f64 {
        self.link_at(self.node(End { gap, right: true }))
    }

    /// Finds the cost of the link over a gap after a change.
    fn relink(&mut self, gap: u32) -> f64 {
        let (left, right) = (self.node(End { gap, right: false }), self.node(End { gap, right: true }));
        let cost = self.link(left, right) + self.surcharge(left, right);
        for (node, across) in [(left, right), (right, left)] {
            let node = &mut self.nodes[node as usize];
            (node.link, node.across) = (cost, across);
        }
        cost
    }

    /// Reverses the walk between two positions (inclusive), which lie in one group or hold whole groups.
    pub fn reverse(&mut self, from: u32, to: u32) {
        if from <= to {
            self.total -= self.gap(from) + self.gap(to + 1);
            self.flip(from, to);
            self.total += self.relink(from) + self.relink(to + 1);
            self.journal.push(Change::Reversed(from, to));
        }
    }

    /// Swaps the neighbouring stretches `[from, middle)` and `[middle, to)`, and reverses either on request.
    pub fn swap(&mut self, from: u32, middle: u32, to: u32, reverse_first: bool, reverse_second: bool) {
        let middle_after = from + (to - middle);
        self.reverse(from, to - 1);
        if !reverse_second {
            self.reverse(from, middle_after - 1);
        }
        if !reverse_first {
            self.reverse(middle_after, to - 1);
        }
    }

    /// Enters a loop elsewhere.
    pub fn enter(&mut self, item: u32, entry: u32) {
        let at = self.position(item);
        self.total -= self.gap(at) + self.gap(at + 1);
        let before = std::mem::replace(&mut self.entry[item as usize], entry);
        self.put(item);
        self.total += self.relink(at) + self.relink(at + 1);
        self.journal.push(Change::Entered { item, before });
    }

    /// Forgets how to undo what was done so far.
    pub fn commit(&mut self) {
        self.journal.clear();
        self.committed = self.total;
    }

    /// Undoes everything since the last [`Self::commit`].
    pub fn undo(&mut self) {
        self.total = self.committed;
        while let Some(change) = self.journal.pop() {
            match change {
                Change::Reversed(from, to) => {
                    self.flip(from, to);
                    self.relink(from);
                    self.relink(to + 1);
                }
                Change::Entered { item, before } => {
                    self.entry[item as usize] = before;
                    self.put(item);
                    let at = self.position(item);
                    self.relink(at);
                    self.relink(at + 1);
                }
            }
        }
    }

    fn put(&mut self, item: u32) {
        let at = self.vertices(item).map_or(ANYWHERE, |v| v[self.entry[item as usize] as usize]);
        self.nodes[2 * item as usize].at = at;
        self.nodes[2 * item as usize + 1].at = at;
    }

    fn flip(&mut self, from: u32, to: u32) {
        self.work += u64::from(to - from) / 8 + 1;
        let stretch = &mut self.entered[from as usize..=to as usize];
        stretch.reverse();
        for (offset, node) in stretch.iter_mut().enumerate() {
            *node ^= 1;
            self.position[*node as usize / 2] = from + offset as u32;
        }
        if self.group_at(from) != self.group_at(to) {
            self.find_spans(from, to);
        }
    }

    /// Finds the groups again that lie between two positions.
    fn find_spans(&mut self, from: u32, to: u32) {
        let mut at = from;
        while at <= to {
            let span = &mut self.span[self.nodes[self.entered[at as usize] as usize].group as usize];
            span.0 = at;
            at += span.1;
        }
    }
}
