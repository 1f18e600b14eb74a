//! Rays through a mesh, from many points in three directions.
//!
//! Seen along a direction a ray is a point: those of all rays are sorted into cells, and each facet looks into the cells
//! that it covers. So the mesh needs no index of its own.

use parry3d::math::Vector;
use parry3d::query::{Ray, RayCast};
use parry3d::shape::Triangle;

/// Along no edge that models have.
const DIRECTIONS: [[f32; 3]; 3] = [[0.36, 0.48, 0.8], [-0.6, 0.64, 0.48], [0.48, -0.36, -0.8]];

/// How many rays leave each point.
pub(super) const COUNT: usize = DIRECTIONS.len();

/// A facet's box is larger by this share of the largest coordinate, as ray casts round.
const SLACK: f64 = 1e-5;

/// A facet that a ray meets.
pub(super) struct Hit {
    /// The number of the point that the ray leaves, and of its direction.
    pub ray: (usize, usize),
    pub facet: u32,
    /// Multiple of the direction.
    pub distance: f32,
    /// It is met from its back.
    pub leaves: bool,
}

/// Calls `see` for every facet that each ray meets, direction by direction, facets ascending. O(facets + hits) for few rays.
pub(super) fn for_each_hit(
    vertices: &[[f32; 3]],
    triangles: &[[u32; 3]],
    origins: &[[f32; 3]],
    mut see: impl FnMut(Hit),
) {
    let largest = vertices.as_flattened().iter().fold(1.0_f32, |most, x| most.max(x.abs()));
    let slack = SLACK * f64::from(largest);
    for (number, &direction) in DIRECTIONS.iter().enumerate() {
        let Some(seen) = Seen::new(origins, direction) else { return };
        let along = Vector::from(direction);
        for (facet, corners) in (0..).zip(triangles) {
            let corners = corners.map(|v| vertices[v as usize]);
            seen.near(corners, slack, |origin| {
                let [a, b, c] = corners.map(Vector::from);
                let (triangle, ray) =
                    (Triangle::new(a, b, c), Ray::new(Vector::from(origins[origin]), along));
                if let Some(distance) = triangle.cast_local_ray(&ray, f32::MAX, false) {
                    let leaves = triangle.scaled_normal().dot(along) > 0.0;
                    see(Hit { ray: (origin, number), facet, distance, leaves });
                }
            });
        }
    }
}

/// Points seen along a direction, in cells.
struct Seen {
    /// Two directions across.
    across: [[f64; 3]; 2],
    at: Vec<[f64; 2]>,
    low: [f64; 2],
    high: [f64; 2],
    /// Cells on each side, and their size.
    side: usize,
    size: [f64; 2],
    cells: Vec<Vec<u32>>,
}

impl Seen {
    /// `None` of no points.
    fn new(origins: &[[f32; 3]], direction: [f32; 3]) -> Option<Self> {
        let [x, y, z] = direction.map(f64::from);
        // None of the directions is along Z.
        let u = [y, -x, 0.0];
        let v = [x * z, y * z, -(x * x + y * y)];
        let across = [u, v];
        let at: Vec<[f64; 2]> = origins.iter().map(|&p| project(across, p)).collect();
        let bound = |f: fn(f64, f64) -> f64| at.iter().copied().reduce(|a, b| [f(a[0], b[0]), f(a[1], b[1])]);
        let (low, high) = (bound(f64::min)?, bound(f64::max)?);
        let side = at.len().isqrt() + 1;
        let size = [0, 1].map(|k| ((high[k] - low[k]) / side as f64).max(f64::MIN_POSITIVE));
        let mut seen = Self { across, at, low, high, side, size, cells: vec![Vec::new(); side * side] };
        for (i, &p) in seen.at.iter().enumerate() {
            let [x, y] = seen.cell(p);
            seen.cells[y * side + x].push(i as u32);
        }
        Some(seen)
    }

    /// The column and row of a place, or the nearest.
    fn cell(&self, p: [f64; 2]) -> [usize; 2] {
        [0, 1].map(|k| (((p[k] - self.low[k]) / self.size[k]) as usize).min(self.side - 1))
    }

    /// Calls `see` with the points in the box around a facet.
    #[inline]
    fn near(&self, corners: [[f32; 3]; 3], slack: f64, mut see: impl FnMut(usize)) {
        let [a, b, c] = corners.map(|p| project(self.across, p));
        let low = [0, 1].map(|k| a[k].min(b[k]).min(c[k]) - slack);
        let high = [0, 1].map(|k| a[k].max(b[k]).max(c[k]) + slack);
        if (0..2).any(|k| high[k] < self.low[k] || low[k] > self.high[k]) {
            return;
        }
        let ([left, bottom], [right, top]) = (self.cell(low), self.cell(high));
        for y in bottom..=top {
            for cell in &self.cells[y * self.side + left..=y * self.side + right] {
                for &i in cell {
                    let p = self.at[i as usize];
                    if (0..2).all(|k| low[k] <= p[k] && p[k] <= high[k]) {
                        see(i as usize);
                    }
                }
            }
        }
    }
}

#[inline]
fn project(across: [[f64; 3]; 2], p: [f32; 3]) -> [f64; 2] {
    let [x, y, z] = p.map(f64::from);
    across.map(|u| u[0] * x + u[1] * y + u[2] * z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn from_inside_a_box_every_ray_meets_one_facet_and_from_outside_none_or_two() {
        let corner = |i: u32| [0, 1, 2].map(|axis| if i >> axis & 1 == 1 { 10.0 } else { 0.0 });
        let vertices: Vec<[f32; 3]> = (0..8).map(corner).collect();
        let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles: Vec<[u32; 3]> =
            sides.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        let grid = (0..7 * 7 * 7).map(|i| [i % 7, i / 7 % 7, i / 49].map(|x| 3.0 * x as f32 - 4.3));
        let origins: Vec<[f32; 3]> = grid.collect();
        let mut hits = vec![[(0, 0); COUNT]; origins.len()];
        for_each_hit(&vertices, &triangles, &origins, |hit| {
            let (all, leaves) = &mut hits[hit.ray.0][hit.ray.1];
            *all += 1;
            *leaves += usize::from(hit.leaves);
        });
        for (origin, hits) in origins.iter().zip(hits) {
            let inside = origin.iter().all(|x| (0.0..10.0).contains(x));
            let wanted: &[(i32, usize)] = if inside { &[(1, 1)] } else { &[(0, 0), (2, 1)] };
            assert!(hits.iter().all(|hits| wanted.contains(hits)), "{origin:?}: {hits:?}");
        }
        assert!(origins.iter().any(|origin| origin.iter().all(|x| (0.0..10.0).contains(x))));
    }
}
