//! Edmonds' blossom algorithm for minimum-cost perfect matching, all trees growing at once.
//!
//! The primal-dual method of Edmonds 1965 (<https://doi.org/10.4153/CJM-1965-045-4>) in the form of linear
//! programming over cuts: every vertex and every odd set (blossom) has a dual, and an edge's slack is its cost less the
//! duals of all sets that hold exactly one of its ends. As in Blossom V (Kolmogorov 2009,
//! <https://doi.org/10.1007/s12532-009-0002-8>), every unmatched vertex is the root of a tree, and an augmentation frees only the two
//! trees it joins. All trees share one clock: duals of outer (plus) sets rise and those of inner (minus) sets fall by one
//! per tick, so that a dual is a value and the tick at which it held, and the next thing to happen is the head of a
//! priority queue (Galil 1986, <https://doi.org/10.1145/6462.6502>).
//!
//! The queue is lazy: an entry may be early, never late. A due time moves forward only when a vertex becomes outer,
//! or turns from inner to free; both are moments at which its edges are scanned again.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// No node, no arc.
pub(super) const NONE: u32 = u32::MAX;

/// Two ends and a cost.
pub type Edge = (u32, u32, i64);

/// An edge seen from one of its ends.
#[derive(Clone, Copy)]
struct Arc {
    head: u32,
    /// `2 · edge + side`; the reverse arc differs in the last bit.
    id: u32,
    cost: i64,
}

/// The graph in compressed rows.
pub(super) struct Graph {
    rows: Vec<u32>,
    arcs: Vec<Arc>,
    /// Tail of each arc by id.
    tails: Vec<u32>,
    /// Cost of each edge.
    costs: Vec<i64>,
}

impl Graph {
    /// Costs are quadrupled, which keeps all duals integers: the parity argument is at [`Solver::due`].
    pub(super) fn new(vertices: usize, edges: &[Edge]) -> Self {
        let mut rows = vec![0_u32; vertices + 2];
        for &(u, v, _) in edges {
            rows[u as usize + 2] += 1;
            rows[v as usize + 2] += 1;
        }
        for i in 2..rows.len() {
            rows[i] += rows[i - 1];
        }
        let mut arcs = vec![Arc { head: 0, id: 0, cost: 0 }; 2 * edges.len()];
        let mut tails = Vec::with_capacity(2 * edges.len());
        for (e, &(u, v, cost)) in edges.iter().enumerate() {
            for (side, (tail, head)) in [(u, v), (v, u)].into_iter().enumerate() {
                let next = &mut rows[tail as usize + 1];
                arcs[*next as usize] = Arc { head, id: (2 * e + side) as u32, cost: 4 * cost };
                *next += 1;
                tails.push(tail);
            }
        }
        rows.pop();
        let costs = edges.iter().map(|&(_, _, cost)| 4 * cost).collect();
        Self { rows, arcs, tails, costs }
    }

    /// Half of each vertex's cheapest edge: duals under which no edge has negative slack.
    pub(super) fn cheapest_halves(&self) -> Vec<i64> {
        (0..self.vertices() as u32)
            .map(|v| self.arcs[self.row(v)].iter().map(|arc| arc.cost / 2).min().unwrap_or(0))
            .collect()
    }

    /// Vertex duals from an earlier run, lowered where an edge that has since joined would have negative slack.
    pub(super) fn feasible(&self, mut duals: Vec<i64>) -> Vec<i64> {
        duals.truncate(self.vertices());
        for v in 0..self.vertices() {
            let row = &self.arcs[self.row(v as u32)];
            let least =
                row.iter().map(|arc| arc.cost - duals[v] - duals[arc.head as usize]).min().unwrap_or(0);
            duals[v] += least.min(0);
            duals[v] -= duals[v] & 1;
        }
        duals
    }

    fn vertices(&self) -> usize {
        self.rows.len() - 1
    }

    fn row(&self, v: u32) -> std::ops::Range<usize> {
        self.rows[v as usize] as usize..self.rows[v as usize + 1] as usize
    }
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Label {
    /// In no tree; its dual rests.
    Free,
    /// Outer: at an even distance from the root; its dual rises.
    Plus,
    /// Inner: at an odd distance; its dual falls.
    Minus,
}

/// A vertex or a blossom.
#[derive(Clone, Copy)]
struct Node {
    /// The dual at tick `since`.
    dual: i64,
    since: i64,
    label: Label,
    /// The blossom that directly holds this node.
    outer: u32,
    /// The matched arc, leaving this node.
    mate: u32,
    /// Inner nodes: the tight arc to the parent.
    up: u32,
    /// The root's vertex, which names the tree.
    tree: u32,
    /// First and last vertex inside, in the list `next`.
    first: u32,
    last: u32,
}

/// State of one run of the algorithm.
pub(super) struct Solver<'a> {
    graph: &'a Graph,
    nodes: Vec<Node>,
    /// Outermost node of each vertex.
    top: Vec<u32>,
    /// Sum of the duals of the sets that hold a vertex, without the outermost.
    inner: Vec<i64>,
    /// Vertices of a node are neighbours in this list.
    next: Vec<u32>,
    /// Children of each blossom around its odd cycle; the arc leads on to the following one.
    cycles: Vec<Vec<(u32, u32)>>,
    spare: Vec<u32>,
    /// Nodes that joined each tree; some may have left.
    members: Vec<Vec<u32>>,
    queue: BinaryHeap<Reverse<(i64, u32)>>,
    /// The earliest entry of each edge in the queue.
    queued: Vec<i64>,
    clock: i64,
    unmatched: usize,
    stamp: Vec<u32>,
    stamps: u32,
}

impl<'a> Solver<'a> {
    /// Starts from vertex duals, which must be even and leave no edge with negative slack.
    pub(super) fn new(graph: &'a Graph, duals: &[i64]) -> Self {
        let n = graph.vertices();
        let node = |v: usize| Node {
            dual: duals[v],
            since: 0,
            label: Label::Free,
            outer: NONE,
            mate: NONE,
            up: NONE,
            tree: NONE,
            first: v as u32,
            last: v as u32,
        };
        Self {
            graph,
            nodes: (0..n).map(node).collect(),
            top: (0..n as u32).collect(),
            inner: vec![0; n],
            next: vec![NONE; n],
            cycles: Vec::new(),
            spare: Vec::new(),
            members: vec![Vec::new(); n],
            queue: BinaryHeap::new(),
            queued: vec![i64::MAX; graph.tails.len() / 2],
            clock: 0,
            unmatched: n,
            stamp: vec![0; n],
            stamps: 0,
        }
    }

    /// Raises each unmatched vertex until an edge is tight, and matches it if that edge's other end is unmatched.
    pub(super) fn match_greedily(&mut self) {
        for v in 0..self.graph.vertices() as u32 {
            if self.nodes[v as usize].mate != NONE {
                continue;
            }
            let slack = |s: &Self, a: &Arc| a.cost - s.nodes[v as usize].dual - s.nodes[a.head as usize].dual;
            let row = &self.graph.arcs[self.graph.row(v)];
            let Some(least) = row.iter().map(|a| slack(self, a)).min() else { continue };
            let open = row
                .iter()
                .find(|a| slack(self, a) == least && self.nodes[a.head as usize].mate == NONE)
                .copied();
            self.nodes[v as usize].dual += least;
            if let Some(arc) = open {
                self.nodes[v as usize].mate = arc.id;
                self.nodes[arc.head as usize].mate = arc.id ^ 1;
                self.unmatched -= 2;
            }
        }
    }

    /// Runs to the end: true if a perfect matching exists.
    pub(super) fn run(&mut self) -> bool {
        let roots: Vec<u32> =
            (0..self.top.len() as u32).filter(|&v| self.nodes[v as usize].mate == NONE).collect();
        for &root in &roots {
            self.attach(root, Label::Plus, root);
        }
        for &root in &roots {
            self.scan(root);
        }
        let edges = self.queued.len() as u32;
        while self.unmatched > 0 {
            let Some(Reverse((tick, event))) = self.queue.pop() else { return false };
            if event >= edges {
                self.clock = tick;
                self.expand_if_due(event - edges);
            } else if self.queued[event as usize] == tick {
                self.clock = tick;
                self.queued[event as usize] = i64::MAX;
                self.tighten(2 * event);
            }
        }
        true
    }

    fn tail(&self, arc: u32) -> u32 {
        self.graph.tails[arc as usize]
    }

    fn top_of_tail(&self, arc: u32) -> u32 {
        self.top[self.tail(arc) as usize]
    }

    fn top_of_head(&self, arc: u32) -> u32 {
        self.top_of_tail(arc ^ 1)
    }

    fn node(&mut self, id: u32) -> &mut Node {
        &mut self.nodes[id as usize]
    }

    fn dual_now(&self, id: u32) -> i64 {
        let node = &self.nodes[id as usize];
        match node.label {
            Label::Free => node.dual,
            Label::Plus => node.dual + (self.clock - node.since),
            Label::Minus => node.dual - (self.clock - node.since),
        }
    }

    /// Sum of the duals of all sets that hold `v`.
    fn potential(&self, v: u32) -> i64 {
        self.inner[v as usize] + self.dual_now(self.top[v as usize])
    }

    fn relabel(&mut self, id: u32, label: Label) {
        let (dual, clock) = (self.dual_now(id), self.clock);
        let node = self.node(id);
        (node.dual, node.since, node.label) = (dual, clock, label);
    }

    /// Puts a node into a tree; an inner blossom gets its appointment for being expanded.
    fn attach(&mut self, id: u32, label: Label, tree: u32) {
        self.relabel(id, label);
        self.node(id).tree = tree;
        self.members[tree as usize].push(id);
        if label == Label::Minus && id as usize >= self.top.len() {
            let due = self.clock + self.nodes[id as usize].dual;
            self.queue.push(Reverse((due, self.queued.len() as u32 + id)));
        }
    }

    /// When an edge will be tight, as things stand.
    ///
    /// Costs are multiples of four and initial duals even, so tight edges join vertices of equal parity, every tree
    /// has its root's, and the slack between two outer vertices, whose roots share the clock, is even.
    fn due(&self, u: u32, v: u32, cost: i64) -> Option<i64> {
        let (p, q) = (self.top[u as usize], self.top[v as usize]);
        if p == q {
            return None;
        }
        let halved = match (self.nodes[p as usize].label, self.nodes[q as usize].label) {
            (Label::Plus, Label::Plus) => 1,
            (Label::Plus, Label::Free) | (Label::Free, Label::Plus) => 0,
            _ => return None,
        };
        Some(self.clock + ((cost - self.potential(u) - self.potential(v)) >> halved))
    }

    /// Makes appointments for the edges at all vertices of a node.
    fn scan(&mut self, id: u32) {
        let Node { first, last, .. } = self.nodes[id as usize];
        let mut v = first;
        loop {
            for at in self.graph.row(v) {
                let arc = self.graph.arcs[at];
                if let Some(due) = self.due(v, arc.head, arc.cost) {
                    self.appoint(arc.id >> 1, due);
                }
            }
            if v == last {
                break;
            }
            v = self.next[v as usize];
        }
    }

    fn appoint(&mut self, edge: u32, due: i64) {
        let queued = &mut self.queued[edge as usize];
        if due < *queued {
            *queued = due;
            self.queue.push(Reverse((due, edge)));
        }
    }

    /// An edge's time has come, unless things changed meanwhile.
    fn tighten(&mut self, arc: u32) {
        let (u, v) = (self.tail(arc), self.tail(arc ^ 1));
        let Some(due) = self.due(u, v, self.graph.costs[arc as usize >> 1]) else { return };
        if due > self.clock {
            return self.appoint(arc >> 1, due);
        }
        let (p, q) = (self.top[u as usize], self.top[v as usize]);
        let (a, b) = (self.nodes[p as usize], self.nodes[q as usize]);
        match (a.label, b.label) {
            (Label::Plus, Label::Free) => self.grow(arc),
            (Label::Free, Label::Plus) => self.grow(arc ^ 1),
            _ if a.tree == b.tree => self.shrink(arc),
            _ => self.augment(arc),
        }
    }

    /// Takes the free node at the arc's head, and its mate, into the tree of the outer node at its tail.
    fn grow(&mut self, arc: u32) {
        let tree = self.nodes[self.top_of_tail(arc) as usize].tree;
        let child = self.top_of_head(arc);
        let mate = self.top_of_head(self.nodes[child as usize].mate);
        self.node(child).up = arc ^ 1;
        self.attach(child, Label::Minus, tree);
        self.attach(mate, Label::Plus, tree);
        self.scan(mate);
    }

    /// The outer node two steps nearer to the root.
    fn grandparent(&self, plus: u32) -> Option<u32> {
        let mate = self.nodes[plus as usize].mate;
        (mate != NONE).then(|| self.top_of_head(self.nodes[self.top_of_head(mate) as usize].up))
    }

    /// Makes the arc matched and flips the paths from both ends to the roots; the two trees dissolve.
    fn augment(&mut self, arc: u32) {
        let ends = [self.top_of_tail(arc), self.top_of_head(arc)];
        for (end, mut arc) in ends.into_iter().zip([arc, arc ^ 1]) {
            let mut plus = end;
            loop {
                let old = std::mem::replace(&mut self.node(plus).mate, arc);
                if old == NONE {
                    break;
                }
                let minus = self.top_of_head(old);
                let up = self.nodes[minus as usize].up;
                self.node(minus).mate = up;
                plus = self.top_of_head(up);
                arc = up ^ 1;
            }
        }
        self.unmatched -= 2;
        let mut freed = Vec::new();
        for end in ends {
            let tree = self.nodes[end as usize].tree;
            for id in std::mem::take(&mut self.members[tree as usize]) {
                let node = self.nodes[id as usize];
                if node.outer != NONE || node.tree != tree || node.label == Label::Free {
                    continue;
                }
                self.relabel(id, Label::Free);
                if node.label == Label::Minus {
                    freed.push(id);
                }
            }
        }
        for id in freed {
            self.scan(id);
        }
    }

    /// The nearest common ancestor of two outer nodes of one tree.
    fn meeting(&mut self, p: u32, q: u32) -> u32 {
        self.stamps += 1;
        let mut walks = [Some(p), Some(q)];
        loop {
            for walk in &mut walks {
                let Some(at) = *walk else { continue };
                if std::mem::replace(&mut self.stamp[at as usize], self.stamps) == self.stamps {
                    return at;
                }
                *walk = self.grandparent(at);
            }
        }
    }

    /// Contracts the odd cycle that an arc between two outer nodes of one tree closes.
    fn shrink(&mut self, arc: u32) {
        let base = self.meeting(self.top_of_tail(arc), self.top_of_head(arc));
        let mut cycle = Vec::new();
        // From the arc's tail up to the base, to be reversed, then from its head up to the base.
        let mut at = self.top_of_tail(arc);
        let mut on = arc;
        while at != base {
            cycle.push((at, on));
            let minus = self.top_of_head(self.nodes[at as usize].mate);
            cycle.push((minus, self.nodes[at as usize].mate ^ 1));
            on = self.nodes[minus as usize].up ^ 1;
            at = self.top_of_tail(on);
        }
        cycle.push((base, on));
        cycle.reverse();
        at = self.top_of_head(arc);
        while at != base {
            let Node { mate, .. } = self.nodes[at as usize];
            let minus = self.top_of_head(mate);
            let up = self.nodes[minus as usize].up;
            cycle.push((at, mate));
            cycle.push((minus, up));
            at = self.top_of_head(up);
        }

        let id = self.spare.pop().unwrap_or(self.nodes.len() as u32);
        let blossom = Node {
            dual: 0,
            since: self.clock,
            label: Label::Plus,
            up: NONE,
            outer: NONE,
            first: self.nodes[base as usize].first,
            last: self.nodes[cycle[cycle.len() - 1].0 as usize].last,
            ..self.nodes[base as usize]
        };
        if id as usize == self.nodes.len() {
            self.nodes.push(blossom);
            self.stamp.push(0);
            self.cycles.push(Vec::new());
        } else {
            self.nodes[id as usize] = blossom;
        }
        self.members[blossom.tree as usize].push(id);
        let mut before = NONE;
        for &(child, _) in &cycle {
            let dual = self.dual_now(child);
            let node = self.node(child);
            (node.dual, node.since, node.outer) = (dual, 0, id);
            let (first, last) = (node.first, node.last);
            if before != NONE {
                self.next[before as usize] = first;
            }
            before = last;
            let mut v = first;
            loop {
                self.top[v as usize] = id;
                self.inner[v as usize] += dual;
                if v == last {
                    break;
                }
                v = self.next[v as usize];
            }
        }
        for &(child, _) in &cycle {
            if self.nodes[child as usize].label == Label::Minus {
                self.scan(child);
            }
        }
        let slot = id as usize - self.top.len();
        self.cycles[slot] = cycle;
    }

    fn expand_if_due(&mut self, id: u32) {
        let node = &self.nodes[id as usize];
        if node.outer == NONE && node.label == Label::Minus && self.dual_now(id) == 0 {
            self.expand(id);
        }
    }

    /// Makes the children outermost again and matches them around the cycle; the caller says what they become.
    fn open(&mut self, id: u32) -> (Vec<(u32, u32)>, usize) {
        let cycle = std::mem::take(&mut self.cycles[id as usize - self.top.len()]);
        for &(child, _) in &cycle {
            let clock = self.clock;
            let node = self.node(child);
            (node.outer, node.label, node.since) = (NONE, Label::Free, clock);
            let Node { first, last, dual, .. } = *node;
            let mut v = first;
            loop {
                self.top[v as usize] = child;
                self.inner[v as usize] -= dual;
                if v == last {
                    break;
                }
                v = self.next[v as usize];
            }
        }
        let mate = self.nodes[id as usize].mate;
        let holder = self.top_of_tail(mate);
        let base = cycle.iter().position(|&(child, _)| child == holder).unwrap_or(0);
        self.node(holder).mate = mate;
        for k in (1..cycle.len()).step_by(2) {
            let (child, arc) = cycle[(base + k) % cycle.len()];
            let (after, _) = cycle[(base + k + 1) % cycle.len()];
            self.node(child).mate = arc;
            self.node(after).mate = arc ^ 1;
        }
        (cycle, base)
    }

    /// Undoes an inner blossom whose dual has come down to zero.
    fn expand(&mut self, id: u32) {
        let Node { up, tree, .. } = self.nodes[id as usize];
        let (cycle, base) = self.open(id);
        // A stale entry of this id in a tree's list or in the queue must find nothing.
        self.node(id).label = Label::Free;
        self.node(id).tree = NONE;
        self.spare.push(id);
        let len = cycle.len();
        let entry = self.top_of_tail(up);
        let mut at = cycle.iter().position(|&(child, _)| child == entry).unwrap_or(base);
        let forwards = self.nodes[entry as usize].mate == cycle[at].1;
        let step = if forwards { 1 } else { len - 1 };
        let mut up = up;
        let mut outer = Vec::new();
        loop {
            let (minus, _) = cycle[at];
            self.node(minus).up = up;
            self.attach(minus, Label::Minus, tree);
            if at == base {
                break;
            }
            at = (at + step) % len;
            let (plus, _) = cycle[at];
            self.attach(plus, Label::Plus, tree);
            outer.push(plus);
            let after = (at + step) % len;
            // The arc from the next inner child back to this outer one.
            up = if forwards { cycle[at].1 ^ 1 } else { cycle[after].1 };
            at = after;
        }
        for plus in outer {
            self.scan(plus);
        }
        for &(child, _) in &cycle {
            if self.nodes[child as usize].label == Label::Free {
                self.scan(child);
            }
        }
    }

    /// The result: mates and duals of vertices, and the blossoms, each with its dual and the set that holds it.
    pub(super) fn finish(mut self) -> Family {
        let n = self.top.len();
        for id in 0..self.nodes.len() as u32 {
            if self.nodes[id as usize].outer == NONE {
                self.relabel(id, Label::Free);
            }
        }
        let outer: Vec<u32> = self.nodes.iter().map(|node| node.outer).collect();
        let duals: Vec<i64> = self.nodes.iter().map(|node| node.dual).collect();
        let mut stack: Vec<u32> = (n as u32..self.nodes.len() as u32)
            .filter(|&id| outer[id as usize] == NONE && !self.cycles[id as usize - n].is_empty())
            .collect();
        while let Some(id) = stack.pop() {
            let (cycle, _) = self.open(id);
            stack.extend(cycle.iter().map(|&(child, _)| child).filter(|&child| child as usize >= n));
        }
        let mates = (0..n).map(|v| self.tail(self.nodes[v].mate ^ 1)).collect();
        Family { mates, duals, outer }
    }
}

/// An optimal matching with its proof: vertices and blossoms, numbered through, as a laminar family of sets.
pub(super) struct Family {
    /// The other end of each vertex's matched edge.
    pub(super) mates: Vec<u32>,
    /// Four times the dual of each set.
    pub(super) duals: Vec<i64>,
    /// The smallest set that holds each set, or `NONE`.
    pub(super) outer: Vec<u32>,
}
