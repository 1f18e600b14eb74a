//! Bodies too near to each other to be printed one after the other.

use geo::{Distance, Euclidean};

use super::area::TOLERANCE_MM;
use super::layout::{Layout, hull};

/// Two bodies of a layout that are nearer to each other than this.
pub(super) fn too_near(layout: &Layout, bodies: &[usize], apart_mm: f64) -> Option<[usize; 2]> {
    let hulls: Vec<Vec<_>> = bodies
        .iter()
        .map(|&body| layout.bodies[body].iter().map(|m| hull(&layout.items[m.item], m.position)).collect())
        .collect();
    let near = |i: usize, j: usize| {
        hulls[i].iter().any(|a| hulls[j].iter().any(|b| Euclidean.distance(a, b) < apart_mm - TOLERANCE_MM))
    };
    let pairs = (0..bodies.len()).flat_map(|i| (0..i).map(move |j| [j, i]));
    pairs.into_iter().find(|&[j, i]| near(i, j)).map(|pair| pair.map(|i| bodies[i]))
}
