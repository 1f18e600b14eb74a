//! A spatial index over the positions where paths can be entered: the tree for searches among fewer and fewer paths.
//! Those that never change have [`KdTree`](super::matching::KdTree).

use super::precedence::Groups;
use super::{Problem, Shape};
use pathwright_geometry::{Bounds, Point};

/// Entries per block. Neighbouring vertices of a loop share a box: 16 keep the tree an order of magnitude
/// smaller than one leaf per vertex would, and a block is scanned in the time of a few tree nodes.
const BLOCK: usize = 16;
/// Blocks per leaf.
const LEAF: usize = 6;
const NONE: u32 = u32::MAX;

/// A tree of boxes over all entries of a problem, one subtree per group.
///
/// Searches see only items that are left and, from the root, only groups that are open; empty subtrees are
/// skipped, so that a search stays O(log n) in practice however few items are left (after Bentley, "K-d trees
/// for semidynamic point sets", 1990, doi:10.1145/98524.98564). Building is O(n log n).
#[derive(Debug)]
pub struct Index<'a> {
    problem: &'a Problem<'a>,
    nodes: Vec<Node>,
    blocks: Vec<Block>,
    /// Leaves that hold item i's blocks: `leaves[first_leaf[i]..first_leaf[i + 1]]`.
    leaves: Vec<u32>,
    first_leaf: Vec<u32>,
    left: Vec<bool>,
    roots: Vec<u32>,
    /// First of the nodes above the groups' roots.
    above: u32,
    root: u32,
}

/// A position where a path can be entered, and its squared distance (square units) from where a search began.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Entry {
    /// Squared distance, square units.
    pub distance2: i64,
    /// Index of the item.
    pub item: u32,
    /// As in [`super::Visit`].
    pub entry: u32,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Bounds,
    parent: u32,
    /// Inner nodes: the children. Leaves: first block, and one past the last.
    from: u32,
    to: u32,
    leaf: bool,
    /// Blocks of items that are left below this node (above the groups' roots: in open groups only).
    count: u32,
    /// Whether searches that begin above this node go into it: false for the roots of closed groups.
    visible: bool,
}

#[derive(Clone, Copy, Debug)]
struct Block {
    bounds: Bounds,
    item: u32,
    entry: u32,
    len: u32,
}

/// The box of some points, of which there is at least one.
fn box_of(points: &[Point]) -> Bounds {
    points[1..].iter().fold(Bounds::spanned(points[0], points[0]), |b, &p| b.joined(&Bounds::spanned(p, p)))
}

/// Twice the coordinate of a box's centre along an axis.
fn center2(bounds: &Bounds, vertical: bool) -> i64 {
    let (low, high) = if vertical { (bounds.min.y, bounds.max.y) } else { (bounds.min.x, bounds.max.x) };
    i64::from(low) + i64::from(high)
}

fn is_taller_than_wide(bounds: &Bounds) -> bool {
    let [width, height] = bounds.size();
    height > width
}

impl<'a> Index<'a> {
    /// Indexes every entry of every item; all items are left, no group is open.
    pub fn new(problem: &'a Problem<'a>, groups: &Groups) -> Self {
        let items = problem.items.len();
        let mut index = Self {
            problem,
            nodes: Vec::with_capacity(2 * items),
            blocks: Vec::with_capacity(2 * items),
            leaves: Vec::new(),
            first_leaf: vec![0; items + 1],
            left: vec![true; items],
            roots: Vec::with_capacity(groups.items.len()),
            above: NONE,
            root: NONE,
        };
        for group in &groups.items {
            let from = index.blocks.len();
            for &item in group {
                index.add_blocks(item);
            }
            let root = index.build_group(from, index.blocks.len());
            index.nodes[root as usize].visible = false;
            index.roots.push(root);
        }
        index.above = index.nodes.len() as u32;
        let mut roots = index.roots.clone();
        if !roots.is_empty() {
            index.root = index.build_above(&mut roots);
        }
        index.list_leaves();
        index
    }

    fn add_blocks(&mut self, item: u32) {
        match self.problem.items[item as usize].shape {
            Shape::Open(ends) => {
                for (entry, end) in ends.into_iter().enumerate() {
                    let bounds = Bounds { min: end, max: end };
                    self.blocks.push(Block { bounds, item, entry: entry as u32, len: 1 });
                }
            }
            Shape::Loop(vertices) => {
                for (block, vertices) in vertices.chunks(BLOCK).enumerate() {
                    let (entry, len) = ((block * BLOCK) as u32, vertices.len() as u32);
                    self.blocks.push(Block { bounds: box_of(vertices), item, entry, len });
                }
            }
        }
    }

    /// A tree over `blocks[from..to]`, which it reorders; returns its root.
    fn build_group(&mut self, from: usize, to: usize) -> u32 {
        let blocks = &mut self.blocks[from..to];
        let bounds = blocks[1..].iter().fold(blocks[0].bounds, |bounds, block| bounds.joined(&block.bounds));
        let node = self.nodes.len() as u32;
        let count = (to - from) as u32;
        if blocks.len() <= LEAF {
            self.nodes.push(Node {
                bounds,
                parent: NONE,
                from: from as u32,
                to: to as u32,
                leaf: true,
                count,
                visible: true,
            });
            return node;
        }
        let (middle, vertical) = (blocks.len() / 2, is_taller_than_wide(&bounds));
        blocks.select_nth_unstable_by_key(middle, |b| (center2(&b.bounds, vertical), b.item, b.entry));
        self.nodes.push(Node { bounds, parent: NONE, from: 0, to: 0, leaf: false, count, visible: true });
        let children = [self.build_group(from, from + middle), self.build_group(from + middle, to)];
        self.adopt(node, children);
        node
    }

    /// A tree whose leaves are the groups' roots.
    fn build_above(&mut self, roots: &mut [u32]) -> u32 {
        if let [root] = *roots {
            return root;
        }
        let bounds_of = |node: u32| self.nodes[node as usize].bounds;
        let bounds =
            roots[1..].iter().fold(bounds_of(roots[0]), |bounds, &root| bounds.joined(&bounds_of(root)));
        let (middle, vertical) = (roots.len() / 2, is_taller_than_wide(&bounds));
        roots.select_nth_unstable_by_key(middle, |&root| (center2(&bounds_of(root), vertical), root));
        let node = self.nodes.len() as u32;
        self.nodes.push(Node { bounds, parent: NONE, from: 0, to: 0, leaf: false, count: 0, visible: true });
        let (low, high) = roots.split_at_mut(middle);
        let children = [self.build_above(low), self.build_above(high)];
        self.adopt(node, children);
        node
    }

    fn adopt(&mut self, node: u32, [from, to]: [u32; 2]) {
        (self.nodes[node as usize].from, self.nodes[node as usize].to) = (from, to);
        self.nodes[from as usize].parent = node;
        self.nodes[to as usize].parent = node;
    }

    fn list_leaves(&mut self) {
        for block in &self.blocks {
            self.first_leaf[block.item as usize + 1] += 1;
        }
        for item in 1..self.first_leaf.len() {
            self.first_leaf[item] += self.first_leaf[item - 1];
        }
        let mut next = self.first_leaf.clone();
        self.leaves = vec![0; self.blocks.len()];
        for (leaf, node) in self.nodes.iter().enumerate().filter(|(_, node)| node.leaf) {
            for block in &self.blocks[node.from as usize..node.to as usize] {
                let slot = &mut next[block.item as usize];
                self.leaves[*slot as usize] = leaf as u32;
                *slot += 1;
            }
        }
    }

    /// All items are left again, no group is open.
    pub fn restore(&mut self) {
        self.left.fill(true);
        for node in (0..self.nodes.len()).rev() {
            let Node { from, to, leaf, .. } = self.nodes[node];
            let above = node >= self.above as usize;
            // Children come after their parents.
            self.nodes[node].count = match leaf {
                true => to - from,
                false if above => 0,
                false => self.nodes[from as usize].count + self.nodes[to as usize].count,
            };
        }
        for &root in &self.roots {
            self.nodes[root as usize].visible = false;
        }
    }

    /// Makes the remaining items of a group visible to searches from the root.
    pub fn open(&mut self, group: u32) {
        let root = self.roots[group as usize];
        self.nodes[root as usize].visible = true;
        let count = self.nodes[root as usize].count;
        self.above(root, |above| *above += count);
    }

    /// Hides an open group from searches from the root.
    pub fn close(&mut self, group: u32) {
        let root = self.roots[group as usize];
        self.nodes[root as usize].visible = false;
        let count = self.nodes[root as usize].count;
        self.above(root, |above| *above -= count);
    }

    fn above(&mut self, node: u32, mut change: impl FnMut(&mut u32)) {
        let mut node = self.nodes[node as usize].parent;
        while node != NONE {
            change(&mut self.nodes[node as usize].count);
            node = self.nodes[node as usize].parent;
        }
    }

    /// Takes an item of a closed group out of all further searches, if it is not out yet. (Nodes above a closed group do not count it.)
    pub fn remove(&mut self, item: u32) {
        if !std::mem::replace(&mut self.left[item as usize], false) {
            return;
        }
        for slot in self.first_leaf[item as usize]..self.first_leaf[item as usize + 1] {
            let mut node = self.leaves[slot as usize];
            loop {
                let here = &mut self.nodes[node as usize];
                here.count -= 1;
                if here.parent >= self.above {
                    break;
                }
                node = here.parent;
            }
        }
    }

    /// The nearest entry among the open groups. Ties go to the lowest item and entry.
    pub fn nearest_open(&self, p: Point) -> Option<Entry> {
        let visible = self.nodes.get(self.root as usize).is_some_and(|root| root.visible);
        if visible { self.nearest(self.root, p, NONE, i64::MAX, |_| true) } else { None }
    }

    /// The nearest remaining entry of a group that `wanted` accepts. Ties go to the lowest item and entry. One item
    /// can be excepted.
    pub fn nearest_in(
        &self,
        group: u32,
        p: Point,
        except: Option<u32>,
        wanted: impl FnMut(&Entry) -> bool,
    ) -> Option<Entry> {
        self.nearest(self.roots[group as usize], p, except.unwrap_or(NONE), i64::MAX, wanted)
    }

    /// The nearest entry of a subtree, of the blocks that are not farther than the bound.
    fn nearest(
        &self,
        root: u32,
        p: Point,
        except: u32,
        bound: i64,
        mut wanted: impl FnMut(&Entry) -> bool,
    ) -> Option<Entry> {
        let mut best: Option<Entry> = None;
        self.search(root, p, bound, &mut |block, bound| {
            if block.item == except {
                return bound;
            }
            for (entry, point) in (block.entry..).zip(self.points(block)) {
                let entry = Entry { distance2: point.distance2(p), item: block.item, entry };
                if best.is_none_or(|best| entry < best) && wanted(&entry) {
                    best = Some(entry);
                }
            }
            best.map_or(bound, |best| bound.min(best.distance2))
        });
        best
    }

    /// The `k` open groups nearest to a point, nearest first, into `found`, their numbers in place of the items'.
    pub fn nearest_groups(&self, p: Point, groups: &Groups, k: usize, found: &mut Vec<Entry>) {
        found.clear();
        if self.nodes.get(self.root as usize).is_none_or(|root| !root.visible) {
            return;
        }
        self.search_groups(self.root, p, groups, k, found);
    }

    /// Looks for the nearest groups in a subtree of whole groups: each is searched for its nearest entry only.
    fn search_groups(&self, node: u32, p: Point, groups: &Groups, k: usize, found: &mut Vec<Entry>) {
        let bound = |found: &[Entry]| if found.len() < k { i64::MAX } else { found[k - 1].distance2 };
        if node >= self.above {
            for (distance2, child) in self.children(node, p) {
                let here = &self.nodes[child as usize];
                if here.count > 0 && here.visible && distance2 <= bound(found) {
                    self.search_groups(child, p, groups, k, found);
                }
            }
            return;
        }
        if let Some(entry) = self.nearest(node, p, NONE, bound(found), |_| true) {
            let entry = Entry { item: groups.of[entry.item as usize], ..entry };
            found.insert(found.partition_point(|other| *other < entry), entry);
            found.truncate(k);
        }
    }

    /// Shows every block of the subtree whose box is not farther than the bound to `visit`, which gets the bound and
    /// returns it as it is from then on. Nearer children go first.
    fn search(&self, node: u32, p: Point, bound: i64, visit: &mut impl FnMut(&Block, i64) -> i64) -> i64 {
        let here = &self.nodes[node as usize];
        if here.count == 0 {
            return bound;
        }
        let mut bound = bound;
        if here.leaf {
            for block in &self.blocks[here.from as usize..here.to as usize] {
                if self.left[block.item as usize] && block.bounds.distance2(p) <= bound {
                    bound = visit(block, bound);
                }
            }
            return bound;
        }
        for (distance2, child) in self.children(node, p) {
            if distance2 <= bound && self.nodes[child as usize].visible {
                bound = self.search(child, p, bound, visit);
            }
        }
        bound
    }

    /// The children of an inner node and their squared distances from a point, the nearer first.
    #[inline]
    fn children(&self, node: u32, p: Point) -> [(i64, u32); 2] {
        let distance = |child: u32| (self.nodes[child as usize].bounds.distance2(p), child);
        let here = &self.nodes[node as usize];
        let (near, far) = (distance(here.from), distance(here.to));
        if far.0 < near.0 { [far, near] } else { [near, far] }
    }

    /// The entries of a block.
    fn points(&self, block: &Block) -> &[Point] {
        let entries = block.entry as usize..(block.entry + block.len) as usize;
        match &self.problem.items[block.item as usize].shape {
            Shape::Open(ends) => &ends[entries],
            Shape::Loop(vertices) => &vertices[entries],
        }
    }
}
