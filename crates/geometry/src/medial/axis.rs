//! The chordal axis of a polygon as a graph.

use spade::{ConstrainedDelaunayTriangulation, Triangulation};

use super::outline::{Outline, Position, distance, lerp};
use crate::sample::Sample;

/// No node.
pub(super) const NONE: u32 = u32::MAX;

/// A node that moves by less, in millimetres, is between its sides: a grid unit.
const SETTLED_MM: f64 = 1e-5;

/// A point of the axis with the width of the region there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    pub(super) at: Position,
    pub(super) width: f64,
    /// How far the region continues beyond this node, if it is the end of a branch.
    pub(super) reach: f64,
    /// Up to three neighbours, [`NONE`] in unused slots.
    pub(super) links: [u32; 3],
    /// Whether it is the centre of a triangle, not the middle between two sides.
    pub(super) junction: bool,
}

impl Node {
    pub(super) fn degree(&self) -> usize {
        self.neighbours().count()
    }

    pub(super) fn neighbours(&self) -> impl Iterator<Item = u32> + use<> {
        self.links.into_iter().filter(|&n| n != NONE)
    }

    fn link(&mut self, to: u32) {
        if let Some(free) = self.links.iter_mut().find(|n| **n == NONE) {
            *free = to;
        }
    }

    pub(super) fn unlink(&mut self, from: u32) {
        if let Some(link) = self.links.iter_mut().find(|n| **n == from) {
            *link = NONE;
        }
    }
}

/// The chordal axis (Prasad 1997, CNLS Newsletter 139): in the constrained Delaunay triangulation of the
/// samples, the middles of inner edges are linked through the triangles inside. Each middle is then moved
/// midway between the two sides that its edge connects. Empty where the samples cannot be triangulated.
pub(super) fn chordal_axis(outline: &Outline) -> Vec<Node> {
    let samples =
        outline.at.iter().enumerate().map(|(i, &at)| Sample { at, index: i as u32 }).collect::<Vec<_>>();
    let edges = outline.next.iter().enumerate().map(|(i, &next)| [i, next as usize]).collect();
    // A constraint that crosses another is left out; only a boundary that touches itself has such.
    let Ok(mesh) = ConstrainedDelaunayTriangulation::<Sample>::try_bulk_load_cdt(samples, edges, |_| ())
    else {
        return Vec::new();
    };
    let inside = inner_faces(&mesh, outline);

    let mut nodes = Vec::with_capacity(mesh.num_inner_faces());
    let mut node_of = vec![NONE; mesh.num_undirected_edges()];
    let mut middle = |nodes: &mut Vec<Node>, edge: usize, a: u32, b: u32| {
        if node_of[edge] == NONE {
            node_of[edge] = nodes.len() as u32;
            nodes.push(between_sides(outline, a, b));
        }
        node_of[edge]
    };
    for face in mesh.inner_faces().filter(|face| inside[face.fix().index()]) {
        let mut around = [NONE; 3];
        let mut count = 0;
        for edge in face.adjacent_edges().into_iter().filter(|edge| !edge.is_constraint_edge()) {
            let (a, b) = (edge.from().data().index, edge.to().data().index);
            around[count] = middle(&mut nodes, edge.as_undirected().fix().index(), a, b);
            count += 1;
        }
        let corners = face.vertices().map(|v| outline.at[v.data().index as usize]);
        match count {
            1 => {
                // The corner opposite to the inner edge, which is the one with two boundary edges.
                let edges = face.adjacent_edges();
                let inner = edges.into_iter().find(|edge| !edge.is_constraint_edge());
                let tip = inner.map_or(corners[0], |edge| outline.at[edge.next().to().data().index as usize]);
                let node = &mut nodes[around[0] as usize];
                node.reach = distance(node.at, tip);
            }
            2 => {
                nodes[around[0] as usize].link(around[1]);
                nodes[around[1] as usize].link(around[0]);
            }
            3 => {
                let junction = nodes.len() as u32;
                nodes.push(junction_of(corners, around));
                for n in around {
                    nodes[n as usize].link(junction);
                }
            }
            _ => {}
        }
    }
    nodes
}

fn junction_of([a, b, c]: [Position; 3], links: [u32; 3]) -> Node {
    let (ab, bc, ca) = (distance(a, b), distance(b, c), distance(c, a));
    let twice_area = ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs();
    // The circle through the corners touches three sides of the region, unless the triangle is obtuse.
    let width = (ab * bc * ca / twice_area).min(ab.max(bc).max(ca));
    let at = [(a[0] + b[0] + c[0]) / 3.0, (a[1] + b[1] + c[1]) / 3.0];
    Node { at, width, reach: width / 2.0, links, junction: true }
}

/// The point midway between the sides around two samples.
fn between_sides(outline: &Outline, a: u32, b: u32) -> Node {
    let (p, q) = (outline.at[a as usize], outline.at[b as usize]);
    let middle = lerp(p, q, 0.5);
    let mut node = Node { at: middle, width: distance(p, q), reach: 0.0, links: [NONE; 3], junction: false };
    for _ in 0..3 {
        let left = outline.nearest_around(a, node.at, middle);
        let right = outline.nearest_around(b, node.at, middle);
        node.width = node.width.min(distance(left, node.at) + distance(right, node.at));
        let moved = lerp(left, right, 0.5);
        // Around corners both sides are one; there the middle is good enough.
        if distance(moved, middle) > 0.25 * distance(p, q) {
            break;
        }
        let by = distance(moved, node.at);
        node.at = moved;
        if by <= SETTLED_MM {
            break;
        }
    }
    node
}

/// Which faces are inside, by face index: those to the left of the boundary, and all that are connected to them.
fn inner_faces(mesh: &ConstrainedDelaunayTriangulation<Sample>, outline: &Outline) -> Vec<bool> {
    let mut inside = vec![false; mesh.num_all_faces()];
    let mut queue = Vec::new();
    for face in mesh.inner_faces() {
        let on_the_left = face.adjacent_edges().into_iter().any(|edge| {
            let (a, b) = (edge.from().data().index, edge.to().data().index);
            edge.is_constraint_edge() && outline.next[a as usize] == b
        });
        if on_the_left {
            inside[face.fix().index()] = true;
            queue.push(face);
        }
    }
    while let Some(face) = queue.pop() {
        for edge in face.adjacent_edges().into_iter().filter(|edge| !edge.is_constraint_edge()) {
            if let Some(neighbour) = edge.rev().face().as_inner()
                && !std::mem::replace(&mut inside[neighbour.fix().index()], true)
            {
                queue.push(neighbour);
            }
        }
    }
    inside
}
