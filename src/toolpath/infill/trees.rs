//! Trees in the plane that stand on a boundary: what [`lightning`](super::lightning) consists of on a layer.

use geometry::{Bounds, Clipper, EdgeGrid, Point, Region, Ring, distance_mm, to_segment_mm, to_units};

/// A node without a parent stands on the boundary.
const ROOT: u32 = u32::MAX;

/// Nodes that leave their line by less are left out, in millimetres.
const STRAIGHT_MM: f64 = 0.01;

/// Roots this near to the boundary stand on it, in millimetres.
const ON_WALL_MM: f64 = 0.01;

/// Edges are sorted into at most this many cells along a side.
const MOST_CELLS: f64 = 1024.0;

/// Branches come off this near to a node at the node itself, in reaches.
const FORK: f64 = 0.25;

#[derive(Clone, Copy, Debug)]
struct Node {
    at: [f64; 2],
    /// Comes before it.
    parent: u32,
}

/// Trees, each node after its parent.
#[derive(Clone, Debug, Default)]
pub(super) struct Forest {
    nodes: Vec<Node>,
}

impl Forest {
    /// Shortens every branch at its tip by a length, and moves the nodes between by at most that towards where their
    /// branches are straight.
    pub(super) fn shrink(&mut self, by_mm: f64) {
        let count = self.nodes.len();
        let old = self.nodes.clone();
        let mut children = vec![0_u32; count];
        let mut only_child = vec![ROOT; count];
        for (i, node) in old.iter().enumerate().filter(|(_, node)| node.parent != ROOT) {
            children[node.parent as usize] += 1;
            only_child[node.parent as usize] = i as u32;
        }
        // What is left to take off where everything beyond a node is gone.
        let mut left_mm = vec![by_mm; count];
        let mut kept = vec![false; count];
        for (i, node) in old.iter().enumerate().rev() {
            if node.parent == ROOT {
                continue;
            }
            let parent = node.parent as usize;
            let length_mm = distance_mm(node.at, old[parent].at);
            if !kept[i] && length_mm <= left_mm[i] {
                left_mm[parent] = left_mm[parent].min(left_mm[i] - length_mm);
                continue;
            }
            if !kept[i] {
                self.nodes[i].at = towards(node.at, old[parent].at, left_mm[i]);
            } else if children[i] == 1 {
                let (from, to) = (old[parent].at, old[only_child[i] as usize].at);
                let beyond_mm = distance_mm(node.at, to);
                let straight = towards(from, to, distance_mm(from, to) * length_mm / (length_mm + beyond_mm));
                self.nodes[i].at = towards(node.at, straight, by_mm);
            }
            kept[i] = true;
            kept[parent] = true;
        }
        self.retain(&kept);
        self.straighten();
    }

    /// Leaves out nodes that are on the line between their neighbours.
    fn straighten(&mut self) {
        let mut children = vec![0_u32; self.nodes.len()];
        let mut only_child = vec![ROOT; self.nodes.len()];
        for (i, node) in self.nodes.iter().enumerate().filter(|(_, node)| node.parent != ROOT) {
            children[node.parent as usize] += 1;
            only_child[node.parent as usize] = i as u32;
        }
        let mut kept = vec![true; self.nodes.len()];
        for i in 0..self.nodes.len() {
            let Node { at, parent } = self.nodes[i];
            if parent == ROOT || children[i] != 1 {
                continue;
            }
            let next = only_child[i] as usize;
            if to_segment_mm(at, self.nodes[parent as usize].at, self.nodes[next].at) < STRAIGHT_MM {
                self.nodes[next].parent = parent;
                kept[i] = false;
            }
        }
        self.retain(&kept);
    }

    /// Takes nodes out; the parents of those that stay do so too.
    fn retain(&mut self, kept: &[bool]) {
        let mut index_of = vec![ROOT; self.nodes.len()];
        let mut nodes = Vec::with_capacity(self.nodes.len());
        for (i, node) in self.nodes.iter().enumerate().filter(|(i, _)| kept[*i]) {
            index_of[i] = nodes.len() as u32;
            let parent = if node.parent == ROOT { ROOT } else { index_of[node.parent as usize] };
            nodes.push(Node { parent, ..*node });
        }
        self.nodes = nodes;
    }

    /// Cuts the trees at the boundary of a region: removes what lies outside, and extends roots inside to the nearest
    /// point of it.
    pub(super) fn ground(&mut self, region: &Region) {
        let clipper = Clipper::new(region);
        let edges = EdgeGrid::new(region);
        let mut nodes: Vec<Node> = Vec::with_capacity(self.nodes.len());
        let mut index_of = vec![ROOT; self.nodes.len()];
        for (i, node) in self.nodes.iter().enumerate() {
            let at = Point::from_mm(node.at[0], node.at[1]);
            if !edges.contains(at) {
                continue;
            }
            let stand = |at: [f64; 2], nodes: &mut Vec<Node>| {
                nodes.push(Node { at, parent: ROOT });
                nodes.len() as u32 - 1
            };
            let parent = if node.parent == ROOT {
                let wall = on_boundary(&edges, at).filter(|(_, away_mm)| *away_mm > ON_WALL_MM);
                wall.map_or(ROOT, |(foot, _)| stand(foot, &mut nodes))
            } else {
                let [x, y] = self.nodes[node.parent as usize].at;
                let piece = clipper.clip(&[at, Point::from_mm(x, y)]).into_iter().next();
                let whole = piece.as_ref().is_some_and(|p| p.points == [at, Point::from_mm(x, y)]);
                match (index_of[node.parent as usize], piece) {
                    (parent, _) if parent != ROOT && whole => parent,
                    (_, Some(piece)) if piece.points[0] == at => stand(piece.points[1].mm(), &mut nodes),
                    _ => ROOT,
                }
            };
            index_of[i] = nodes.len() as u32;
            nodes.push(Node { at: at.mm(), parent });
        }
        self.nodes = nodes;
    }

    /// Grows branches to points of a region further than `reach_mm` from its boundary and from all branches, until there
    /// is none. Those nearest to the boundary come first, so that branches grow from there inwards.
    pub(super) fn hold(&mut self, points: &[Point], region: &Region, reach_mm: f64) {
        let edges = EdgeGrid::new(region);
        let Some(mut near) = Near::new(points, reach_mm) else { return };
        (0..self.nodes.len()).for_each(|i| near.add(self.edge(i), i as u32));
        let wanting = points.iter().filter(|p| near.nearest(self, p.mm(), reach_mm).is_none());
        let mut wanting: Vec<([f64; 2], f64, Point)> = wanting
            .filter_map(|&p| on_boundary(&edges, p).map(|(wall, away_mm)| (wall, away_mm, p)))
            .filter(|(_, away_mm, _)| *away_mm > reach_mm)
            .collect();
        wanting.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.2.cmp(&b.2)));
        for (wall, wall_mm, p) in wanting {
            if near.nearest(self, p.mm(), reach_mm).is_some() {
                continue;
            }
            let parent = match near.nearest(self, p.mm(), wall_mm) {
                Some((i, at)) => self.fork(i, at, reach_mm, &mut near),
                None => {
                    self.nodes.push(Node { at: wall, parent: ROOT });
                    self.nodes.len() as u32 - 1
                }
            };
            self.nodes.push(Node { at: p.mm(), parent });
            let last = self.nodes.len() - 1;
            near.add(self.edge(last), last as u32);
        }
        self.sort();
    }

    /// Puts parents before their children again.
    fn sort(&mut self) {
        let mut children: Vec<Vec<u32>> = vec![Vec::new(); self.nodes.len()];
        let mut next: Vec<(u32, u32)> = Vec::new();
        for (i, node) in self.nodes.iter().enumerate().rev() {
            match children.get_mut(node.parent as usize) {
                Some(siblings) => siblings.push(i as u32),
                None => next.push((i as u32, ROOT)),
            }
        }
        let mut nodes = Vec::with_capacity(self.nodes.len());
        while let Some((i, parent)) = next.pop() {
            next.extend(children[i as usize].iter().map(|&child| (child, nodes.len() as u32)));
            nodes.push(Node { parent, ..self.nodes[i as usize] });
        }
        self.nodes = nodes;
    }

    /// A node at a position on the edge to another's parent, or a node near there.
    fn fork(&mut self, i: u32, at: [f64; 2], reach_mm: f64, near: &mut Near) -> u32 {
        let Node { at: tip, parent } = self.nodes[i as usize];
        if parent == ROOT || distance_mm(at, tip) < FORK * reach_mm {
            return i;
        }
        if distance_mm(at, self.nodes[parent as usize].at) < FORK * reach_mm {
            return parent;
        }
        let middle = self.nodes.len();
        self.nodes.push(Node { at, parent });
        self.nodes[i as usize].parent = middle as u32;
        near.add(self.edge(middle), middle as u32);
        middle as u32
    }

    /// A node's index and its parent's.
    fn edge(&self, i: usize) -> [[f64; 2]; 2] {
        let Node { at, parent } = self.nodes[i];
        [at, self.nodes.get(parent as usize).map_or(at, |parent| parent.at)]
    }

    /// The trees as few lines: each runs from a tip towards the root until it meets a longer one.
    pub(super) fn strokes(&self) -> Vec<Ring> {
        let count = self.nodes.len();
        let mut reach_mm = vec![0.0_f64; count];
        let mut longest = vec![ROOT; count];
        for (i, node) in self.nodes.iter().enumerate().rev() {
            let Some(parent) = self.nodes.get(node.parent as usize) else { continue };
            let up_mm = reach_mm[i] + distance_mm(node.at, parent.at);
            if up_mm > reach_mm[node.parent as usize] {
                reach_mm[node.parent as usize] = up_mm;
                longest[node.parent as usize] = i as u32;
            }
        }
        let mut strokes = Vec::new();
        for (i, node) in self.nodes.iter().enumerate() {
            let begins = node.parent == ROOT || longest[node.parent as usize] != i as u32;
            if !begins {
                continue;
            }
            let from = (node.parent != ROOT).then_some(node.parent).into_iter();
            let onward =
                std::iter::successors(Some(i as u32), |&i| Some(longest[i as usize]).filter(|&n| n != ROOT));
            let mut stroke: Ring = from
                .chain(onward)
                .map(|i| self.nodes[i as usize].at)
                .map(|[x, y]| Point::from_mm(x, y))
                .collect();
            stroke.dedup();
            if stroke.len() > 1 {
                strokes.push(stroke);
            }
        }
        strokes
    }
}

/// Edges of a forest, to be found by where they are. More come while it is searched; [`EdgeGrid`] is
/// for outlines that stay.
struct Near {
    low: [f64; 2],
    cell_mm: f64,
    size: [usize; 2],
    cells: Vec<Vec<u32>>,
}

impl Near {
    /// Cells of a side over some points; `None` without points.
    fn new(points: &[Point], cell_mm: f64) -> Option<Self> {
        let bounds = Bounds::of(points.iter().copied())?;
        let (low, high) = (bounds.min.mm(), bounds.max.mm());
        let cell_mm = cell_mm.max((high[0] - low[0]).max(high[1] - low[1]) / MOST_CELLS);
        let size = [0, 1].map(|i| ((high[i] - low[i]) / cell_mm) as usize + 1);
        Some(Self { low, cell_mm, size, cells: vec![Vec::new(); size[0] * size[1]] })
    }

    /// The cells that a box comes into; beyond the points the nearest ones.
    fn cells(&self, from: [f64; 2], to: [f64; 2]) -> impl Iterator<Item = usize> + use<> {
        let cell = |at: [f64; 2]| {
            [0, 1].map(|i| (((at[i] - self.low[i]) / self.cell_mm).max(0.0) as usize).min(self.size[i] - 1))
        };
        let ([x0, y0], [x1, y1], columns) = (cell(from), cell(to), self.size[0]);
        (y0..=y1).flat_map(move |y| (x0..=x1).map(move |x| y * columns + x))
    }

    fn add(&mut self, [a, b]: [[f64; 2]; 2], edge: u32) {
        let bound = |pick: fn(f64, f64) -> f64| [0, 1].map(|i| pick(a[i], b[i]));
        for cell in self.cells(bound(f64::min), bound(f64::max)) {
            self.cells[cell].push(edge);
        }
    }

    /// The node whose edge to its parent comes nearest to a position, at most so far away, and where it does.
    fn nearest(&self, forest: &Forest, p: [f64; 2], within_mm: f64) -> Option<(u32, [f64; 2])> {
        let mut reach_mm = self.cell_mm.min(within_mm);
        loop {
            let cells = self.cells(p.map(|v| v - reach_mm), p.map(|v| v + reach_mm));
            let edges = cells.flat_map(|cell| &self.cells[cell]).map(|&i| {
                let [a, b] = forest.edge(i as usize);
                let at = foot(p, a, b);
                (distance_mm(p, at), i, at)
            });
            let found = edges.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            match found {
                Some((away_mm, i, at)) if away_mm <= reach_mm => return Some((i, at)),
                _ if reach_mm >= within_mm => return None,
                _ => reach_mm = (2.0 * reach_mm).min(within_mm),
            }
        }
    }
}

/// The nearest position on the boundary, and how far it is.
fn on_boundary(edges: &EdgeGrid, p: Point) -> Option<([f64; 2], f64)> {
    let mut near = Vec::new();
    let mut reach_mm = 1.0;
    while !edges.edges().is_empty() {
        near.clear();
        edges.near_box(Bounds { min: p, max: p }.grown(to_units(reach_mm)), &mut near);
        let feet = near.iter().map(|&i| {
            let edge = &edges.edges()[i as usize];
            let at = foot(p.mm(), edge.a.mm(), edge.b.mm());
            (at, distance_mm(p.mm(), at))
        });
        let found = feet.min_by(|a, b| a.1.total_cmp(&b.1));
        if found.is_some_and(|(_, away_mm)| away_mm <= reach_mm) || near.len() == edges.edges().len() {
            return found;
        }
        reach_mm *= 2.0;
    }
    None
}

/// The nearest position to another on a line between two.
fn foot(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    let length2 = (b[0] - a[0]).powi(2) + (b[1] - a[1]).powi(2);
    let along = (p[0] - a[0]) * (b[0] - a[0]) + (p[1] - a[1]) * (b[1] - a[1]);
    let t = (along / length2.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    [0, 1].map(|i| a[i] + t * (b[i] - a[i]))
}

/// A position moved so far towards another, at most to it.
fn towards(from: [f64; 2], to: [f64; 2], by_mm: f64) -> [f64; 2] {
    let t = (by_mm / distance_mm(from, to).max(f64::MIN_POSITIVE)).min(1.0);
    [0, 1].map(|i| from[i] + t * (to[i] - from[i]))
}
