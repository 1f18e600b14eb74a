//! Holes filled with facets.
//!
//! A loop of open edges gets the facets of least area that it bounds (Barequet & Sharir, Filling gaps in the boundary of a
//! polyhedron, 1995, doi:10.1016/0167-8396(94)00011-G). Whether they are what was there depends on the loop and on the
//! surface around it: in a plane that continues beyond a part of the rim they are; where the surface bends towards the
//! hole, what is missing bulged.

use std::f64::consts::PI;

use super::doubts::Doubtful;
use crate::mesh::edges::{Edges, NO_TWIN, ends};
use crate::mesh::measure::{Vec3, area_mm2, length_mm, normal, point};
use geometry::DisjointSets;
use geometry::real;

/// The facets that close holes.
#[derive(Default)]
pub(super) struct Filled {
    pub facets: Vec<[u32; 3]>,
    pub holes: usize,
    pub doubts: Vec<Doubtful>,
}

/// Larger loops are left open. The time grows with the third power.
const MOST_EDGES: usize = 320;

/// This many facets are tried in all; what would take more stays open.
const PATIENCE: usize = 40_000_000;

/// At a vertex with more open edges the rest are left alone: it is no mesh that can be repaired, and must not take long.
const MOST_OPEN: usize = 64;

/// What is not larger than this many times the facets that would close it is a sheet.
const SHEET: f64 = 1.05;

/// Facets that differ by less than 3° lie in one plane.
const COPLANAR: f64 = 0.9986;

/// Facets that lean less than this against the rim's plane may continue beyond it to a tip: 75°.
const STEEP: f64 = 0.26;

/// A surface whose normals turn less than this from one row of facets to the next, as a cosine, is straight.
const STRAIGHT: f64 = 0.01;

/// Fills loops of open edges. O(open edges + n³) for loops of n edges.
pub(super) fn fill(vertices: &[[f32; 3]], triangles: &[[u32; 3]], edges: &Edges) -> Filled {
    let mut filled = Filled::default();
    let mut patience = PATIENCE;
    let surface = Surface { vertices, triangles, twins: &edges.twins };
    let (patch_of, patch_mm2) = surface.patches();
    for rim in loops(triangles, &edges.twins) {
        let n = rim.len();
        if n > MOST_EDGES || patience < n * n * n / 6 {
            continue;
        }
        patience -= n * n * n / 6;
        let corners: Vec<u32> = rim.iter().map(|&half| ends(triangles, half).1).collect();
        let facets = least_area(vertices, &corners);
        // A sheet by itself has nothing inside.
        let area_mm2: f64 = facets.iter().map(|f| area_mm2(vertices, *f)).sum();
        if patch_mm2[patch_of[rim[0] as usize / 3] as usize] < SHEET * area_mm2 {
            continue;
        }
        filled.doubts.extend(surface.doubt(&rim, &corners, &facets));
        filled.facets.extend(facets);
        filled.holes += 1;
    }
    filled
}

/// Loops of open half-edges, each in the direction in which its hole is walked round: against that of the half-edges.
fn loops(triangles: &[[u32; 3]], twins: &[u32]) -> Vec<Vec<u32>> {
    // By the vertex where the hole's edge begins.
    let open = (0..twins.len() as u32).filter(|&h| twins[h as usize] == NO_TWIN);
    let mut from: Vec<(u32, u32)> = open.map(|half| (ends(triangles, half).1, half)).collect();
    from.sort_unstable();
    let to = |i: usize| ends(triangles, from[i].1).0;
    let fan = |vertex: u32| {
        let start = from.partition_point(|(from, _)| *from < vertex);
        let from = &from;
        (start..from.len()).take(MOST_OPEN).take_while(move |&i| from[i].0 == vertex)
    };
    let mut used = vec![false; from.len()];
    let mut found = Vec::new();
    // Three edges first: those can be closed in one manner only. Where holes meet, an edge may belong to either of two.
    for first in 0..from.len() {
        let closes =
            |&next: &usize| fan(to(next)).find(|&last| to(last) == from[first].0).map(|last| (next, last));
        let mut corners = fan(to(first)).filter_map(|next| closes(&next));
        if let (Some((next, last)), None) = (corners.next(), corners.next())
            && !used[first]
            && !used[next]
            && !used[last]
        {
            for i in [first, next, last] {
                used[i] = true;
            }
            found.push([first, next, last].map(|i| from[i].1).to_vec());
        }
    }
    for first in 0..from.len() {
        if used[first] {
            continue;
        }
        let mut path: Vec<usize> = vec![first];
        used[first] = true;
        while let Some(&last) = path.last() {
            let to = to(last);
            // A vertex that the path has been at closes a loop.
            if let Some(at) = path.iter().rposition(|&p| from[p].0 == to) {
                let closed: Vec<u32> = path.drain(at..).map(|p| from[p].1).collect();
                if closed.len() >= 3 {
                    found.push(closed);
                }
                continue;
            }
            match fan(to).find(|&i| !used[i]) {
                Some(next) if path.len() < 4 * MOST_EDGES => {
                    used[next] = true;
                    path.push(next);
                }
                _ => {
                    path.pop();
                }
            }
        }
    }
    found
}

/// The triangulation of a loop that has the least area, by dynamic programming over stretches of it.
fn least_area(vertices: &[[f32; 3]], corners: &[u32]) -> Vec<[u32; 3]> {
    let n = corners.len();
    let points: Vec<Vec3> = corners.iter().map(|&v| point(vertices, v)).collect();
    let area = |i: usize, j: usize, k: usize| (points[j] - points[i]).cross(&(points[k] - points[i])).norm();
    let mut best = vec![(0.0, 0u32); n * n];
    for width in 2..n {
        for i in 0..n - width {
            let k = i + width;
            let cost = |j: usize| best[i * n + j].0 + best[j * n + k].0 + area(i, j, k);
            let least = (i + 1..k).map(|j| (cost(j), j as u32)).min_by(|a, b| a.0.total_cmp(&b.0));
            best[i * n + k] = least.unwrap_or_default();
        }
    }
    let mut facets = Vec::with_capacity(n - 2);
    let mut open = vec![(0, n - 1)];
    while let Some((i, k)) = open.pop() {
        if k < i + 2 {
            continue;
        }
        let j = best[i * n + k].1 as usize;
        facets.push([corners[i], corners[j], corners[k]]);
        open.extend([(i, j), (j, k)]);
    }
    facets
}

/// The surface around a hole.
struct Surface<'a> {
    vertices: &'a [[f32; 3]],
    triangles: &'a [[u32; 3]],
    twins: &'a [u32],
}

impl Surface<'_> {
    /// For each facet, the number of its part connected by edges, and the area of each.
    fn patches(&self) -> (Vec<u32>, Vec<f64>) {
        let mut parts = DisjointSets::new(self.triangles.len());
        for (half, &twin) in (0..).zip(self.twins).filter(|(half, twin)| **twin != NO_TWIN && *half < **twin)
        {
            parts.join(half / 3, twin / 3);
        }
        let (patch_of, count) = parts.number();
        let mut patch_mm2 = vec![0.0; count];
        for (triangle, &patch) in self.triangles.iter().zip(&patch_of) {
            patch_mm2[patch as usize] += area_mm2(self.vertices, *triangle);
        }
        (patch_of, patch_mm2)
    }

    fn direction(&self, triangle: usize) -> Vec3 {
        normal(self.vertices, self.triangles[triangle]).try_normalize(0.0).unwrap_or_default()
    }

    /// How much volume may have been beyond the facets that close a hole.
    fn doubt(&self, rim: &[u32], corners: &[u32], facets: &[[u32; 3]]) -> Option<Doubtful> {
        let across: Vec3 = facets.iter().map(|f| normal(self.vertices, *f)).sum();
        let up = across.try_normalize(1e-12)?;
        let area_mm2: f64 = facets.iter().map(|f| normal(self.vertices, *f).norm() / 2.0).sum();
        let radius_mm = (area_mm2 / PI).sqrt();
        let heights: Vec<f64> = corners.iter().map(|&v| point(self.vertices, v).dot(&up)).collect();
        let mean_mm = heights.iter().sum::<f64>() / heights.len() as f64;
        let off_mm = heights.iter().map(|h| (h - mean_mm).abs()).fold(0.0, f64::max);
        let bent_mm3 = if off_mm > 1e-3 * radius_mm + 1e-3 { area_mm2 * off_mm } else { 0.0 };
        let volume_mm3 = bent_mm3.max(self.beyond_mm3(rim, up, area_mm2, radius_mm, bent_mm3 == 0.0));
        (volume_mm3 > 0.0).then(|| {
            let cause = "a hole was filled across a surface that may have bulged there";
            Doubtful::around(cause, volume_mm3, corners.iter().map(|&v| self.vertices[v as usize]))
        })
    }

    /// Volume that a smooth or straight continuation of the surface would enclose above the hole.
    fn beyond_mm3(&self, rim: &[u32], up: Vec3, area_mm2: f64, radius_mm: f64, level: bool) -> f64 {
        let (mut rim_mm, mut coplanar_mm, mut lean, mut turn) = (0.0, 0.0, 0.0, 0.0);
        let mut least = 1.0f64;
        for &half in rim {
            let length_mm = length_mm(self.vertices, self.triangles, half);
            let triangle = half as usize / 3;
            let cosine = self.direction(triangle).dot(&up);
            let behind = (3 * triangle..3 * triangle + 3).filter_map(|h| {
                let twin = self.twins[h];
                (twin != NO_TWIN).then(|| self.direction(twin as usize / 3).dot(&up))
            });
            let (count, sum) = behind.fold((0.0, 0.0), |(count, sum), c| (count + 1.0, sum + c));
            rim_mm += length_mm;
            lean += length_mm * cosine;
            turn += length_mm * if count > 0.0 { cosine - sum / count } else { 0.0 };
            least = least.min(cosine);
            if cosine > COPLANAR {
                coplanar_mm += length_mm;
            }
        }
        let (lean, turn) = (lean / rim_mm.max(f64::MIN_POSITIVE), turn / rim_mm.max(f64::MIN_POSITIVE));
        if level && coplanar_mm > 0.1 * rim_mm && least < COPLANAR || coplanar_mm >= 0.999 * rim_mm {
            return 0.0;
        }
        let angle = real::acos(lean.clamp(-0.95, 1.0));
        // One facet is missing where there is no room for more.
        if rim.len() == 3 && (least < STEEP || lean > 0.9) {
            return 0.0;
        }
        if turn < STRAIGHT {
            return if lean < STEEP { 0.0 } else { area_mm2 * radius_mm * real::tan(angle) / 3.0 };
        }
        let height_mm = radius_mm * real::tan(angle / 2.0);
        PI * height_mm * (3.0 * radius_mm.powi(2) + height_mm.powi(2)) / 6.0
    }
}
