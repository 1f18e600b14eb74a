//! Polygons as triangles between their corners.

use rustc_hash::FxHashSet;
use spade::{ConstrainedDelaunayTriangulation, Triangulation};

use crate::sample::Sample;

/// Triangles that cover the polygon of the corners, given and returned counter-clockwise; none if its sides cross.
///
/// The polygon may touch itself, such as where a hole is joined to the outline by a line there and back. O(n log n) for n corners.
#[must_use]
pub fn triangles(corners: &[[f64; 2]]) -> Vec<[u32; 3]> {
    let count = corners.len();
    let next = |i: usize| if i + 1 < count { i + 1 } else { 0 };
    let samples = corners.iter().zip(0..).map(|(&at, index)| Sample { at, index }).collect();
    let sides = (0..count).map(|i| [i, next(i)]).collect();
    let mut crossed = false;
    let mesh =
        ConstrainedDelaunayTriangulation::<Sample>::try_bulk_load_cdt(samples, sides, |_| crossed = true);
    let Some(mesh) = mesh.ok().filter(|_| !crossed) else { return Vec::new() };

    // Corners at one place are one vertex, so that sides are known by where they are.
    let key = |[x, y]: [f64; 2]| [(x + 0.0).to_bits(), (y + 0.0).to_bits()];
    let ways: FxHashSet<_> = (0..count).map(|i| [key(corners[i]), key(corners[next(i)])]).collect();
    let mut queue = Vec::new();
    let mut inside = vec![false; mesh.num_all_faces()];
    for face in mesh.inner_faces() {
        let is_left = |from: [f64; 2], to: [f64; 2]| ways.contains(&[key(from), key(to)]);
        if face.adjacent_edges().iter().any(|edge| is_left(edge.from().data().at, edge.to().data().at)) {
            inside[face.fix().index()] = true;
            queue.push(face);
        }
    }
    let mut found = Vec::with_capacity(count);
    while let Some(face) = queue.pop() {
        found.push(face.vertices().map(|corner| corner.data().index));
        for edge in face.adjacent_edges().into_iter().filter(|edge| !edge.is_constraint_edge()) {
            if let Some(neighbour) = edge.rev().face().as_inner()
                && !std::mem::replace(&mut inside[neighbour.fix().index()], true)
            {
                queue.push(neighbour);
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The area of the triangles, each of which has to be counter-clockwise.
    fn area(corners: &[[f64; 2]]) -> f64 {
        let area = |t: [u32; 3]| {
            let [a, b, c] = t.map(|i| corners[i as usize]);
            ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2.0
        };
        triangles(corners).into_iter().map(area).inspect(|area| assert!(*area > 0.0)).sum()
    }

    #[test]
    fn what_is_outside_of_a_notch_or_a_hole_is_left_out() {
        let notched = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 1.0], [0.0, 4.0]];
        assert_eq!(area(&notched), 10.0);
        let (outer, hole) = (
            [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [0.0, 0.0]],
            [[1.0, 1.0], [1.0, 3.0], [3.0, 3.0], [3.0, 1.0], [1.0, 1.0]],
        );
        assert_eq!(area(&[outer, hole].concat()), 12.0);
    }

    #[test]
    fn sides_that_cross_and_points_on_a_line_have_none() {
        assert_eq!(triangles(&[[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0]]), Vec::<[u32; 3]>::new());
        assert_eq!(triangles(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]), Vec::<[u32; 3]>::new());
        assert_eq!(triangles(&[[0.0, 0.0], [f64::NAN, 0.0], [2.0, 0.0]]), Vec::<[u32; 3]>::new());
    }
}
