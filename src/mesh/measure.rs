//! Lengths, areas and directions of a mesh as it is read.

use geometry::real::{greater, lesser};

use super::edges::ends;

/// A point or direction, exactly as read.
pub(super) type Vec3 = nalgebra::Vector3<f64>;

pub(super) fn point(vertices: &[[f32; 3]], v: u32) -> Vec3 {
    Vec3::from(vertices[v as usize].map(f64::from))
}

/// The facet's normal, as long as twice its area.
pub(super) fn normal(vertices: &[[f32; 3]], [a, b, c]: [u32; 3]) -> Vec3 {
    let [a, b, c] = [a, b, c].map(|v| point(vertices, v));
    (b - a).cross(&(c - a))
}

pub(super) fn area_mm2(vertices: &[[f32; 3]], triangle: [u32; 3]) -> f64 {
    normal(vertices, triangle).norm() / 2.0
}

/// Length of a half-edge.
pub(super) fn length_mm(vertices: &[[f32; 3]], triangles: &[[u32; 3]], half: u32) -> f64 {
    let (a, b) = ends(triangles, half);
    (point(vertices, b) - point(vertices, a)).norm()
}

/// Extends a box to a point.
#[inline]
pub(super) fn extend(min: &mut [f32; 3], max: &mut [f32; 3], [x, y, z]: [f32; 3]) {
    *min = [lesser(x, min[0]), lesser(y, min[1]), lesser(z, min[2])];
    *max = [greater(x, max[0]), greater(y, max[1]), greater(z, max[2])];
}

/// Keeps the elements that are marked.
pub(super) fn keep<T>(of: &mut Vec<T>, stays: &[bool]) {
    let mut stays = stays.iter();
    of.retain(|_| stays.next().is_none_or(|stays| *stays));
}

/// Volume of the tetrahedron from a facet to a point behind it, and area of the facet.
pub(crate) fn facet_measures(corners: [[f64; 3]; 3], apex: [f64; 3]) -> (f64, f64) {
    let [a, b, c] = corners;
    let minus = |p: [f64; 3], q: [f64; 3]| [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
    let (u, v, w) = (minus(b, a), minus(c, a), minus(a, apex));
    let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let dot = |p: [f64; 3], q: [f64; 3]| p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
    (dot(w, normal) / 6.0, dot(normal, normal).sqrt() / 2.0)
}
