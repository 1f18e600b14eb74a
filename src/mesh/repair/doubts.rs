//! How much volume a repair may have got wrong.

use std::fmt;

use serde::Serialize;

use crate::mesh::edges::NO_TWIN;
use crate::mesh::measure::extend;

/// How far the repaired volume may be from what was meant, why, and where. `Display` gives it in words.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Doubt {
    /// What is not sure.
    pub cause: String,
    /// Lower corner of the location, in the file's coordinates.
    pub min_mm: [f64; 3],
    /// Upper corner of the position.
    pub max_mm: [f64; 3],
    /// Volume in doubt.
    pub volume_mm3: f64,
    /// Volume in doubt as a share of the repaired volume, at most 1.
    pub share: f64,
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ([x0, y0, z0], [x1, y1, z1]) = (self.min_mm, self.max_mm);
        write!(
            f,
            "about {:.3} cm³ ({:.1} % of the volume) within X{x0:.1} … {x1:.1}, Y{y0:.1} … {y1:.1}, \
             Z{z0:.1} … {z1:.1}: {}",
            self.volume_mm3 / 1000.0,
            100.0 * self.share,
            self.cause
        )
    }
}

/// Volume in doubt at one location.
#[derive(Clone, Debug)]
pub(super) struct Doubtful {
    pub cause: &'static str,
    pub volume_mm3: f64,
    pub min: [f32; 3],
    pub max: [f32; 3],
}

impl Doubtful {
    /// In the box around some points.
    pub fn around(cause: &'static str, volume_mm3: f64, points: impl Iterator<Item = [f32; 3]>) -> Self {
        let (mut min, mut max) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        points.for_each(|point| extend(&mut min, &mut max, point));
        Self { cause, volume_mm3, min, max }
    }
}

/// Doubts that are less than this share of the volume are not reported.
const LEAST_SHARE: f64 = 3e-3;

/// All doubts as one, if they matter; at most as much as has room in the box around all.
pub(super) fn sum(doubts: &[Doubtful], volume_mm3: f64, vertices: &[[f32; 3]]) -> Option<Doubt> {
    if doubts.is_empty() {
        return None;
    }
    let all = Doubtful::around("", 0.0, vertices.iter().copied());
    let box_mm3: f64 = (0..3).map(|i| f64::from(all.max[i] - all.min[i])).product();
    let total_mm3 = doubts.iter().map(|d| d.volume_mm3).sum::<f64>().min(box_mm3);
    let share = total_mm3 / volume_mm3.abs().max(f64::MIN_POSITIVE);
    if share < LEAST_SHARE {
        return None;
    }
    // Where most of it is.
    let largest_mm3 = doubts.iter().map(|d| d.volume_mm3).fold(0.0, f64::max);
    let chief = || doubts.iter().filter(|d| d.volume_mm3 >= 0.1 * largest_mm3);
    let mut causes: Vec<&str> = Vec::new();
    for doubt in chief() {
        if !causes.contains(&doubt.cause) {
            causes.push(doubt.cause);
        }
    }
    let fold = |f: fn(f32, f32) -> f32, of: fn(&Doubtful) -> [f32; 3]| {
        let corners = chief().map(of);
        corners.reduce(|a, b| std::array::from_fn(|i| f(a[i], b[i]))).unwrap_or_default().map(f64::from)
    };
    Some(Doubt {
        cause: causes.join("; "),
        min_mm: fold(f32::min, |d| d.min),
        max_mm: fold(f32::max, |d| d.max),
        volume_mm3: total_mm3,
        share: share.min(1.0),
    })
}

/// Lines that are shot through a mesh along each axis: this many by this many.
const LINES: usize = 64;

/// An intersection of a line with the surface: its position, and whether the line enters.
type Hit = (f64, bool);

/// Volume along lines that do not leave the surface as often as they enter it, of the axis with the most: where the mesh
/// is open still, or its facets disagree. O(triangles · lines that meet each).
pub(super) fn along_lines(
    vertices: &[[f32; 3]],
    triangles: &[[u32; 3]],
    cause: &'static str,
) -> Option<Doubtful> {
    let found = (0..3).filter_map(|axis| along_axis(vertices, triangles, axis, cause));
    found.max_by(|a, b| a.volume_mm3.total_cmp(&b.volume_mm3))
}

/// How much volumes differ that are taken along each axis (divergence theorem), which agree where a surface is closed. It tells
/// of what is missing where lines leave as often as they enter: two facets opposite to each other.
pub(super) fn between_axes(
    vertices: &[[f32; 3]],
    triangles: &[[u32; 3]],
    cause: &'static str,
) -> Option<Doubtful> {
    let all = Doubtful::around(cause, 0.0, triangles.iter().flatten().map(|&i| vertices[i as usize]));
    let middle = [0, 1, 2].map(|k| (f64::from(all.min[k]) + f64::from(all.max[k])) / 2.0);
    let mut volumes_mm3 = [0.0; 3];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|i| {
            let p = vertices[i as usize];
            [0, 1, 2].map(|k| f64::from(p[k]) - middle[k])
        });
        for (k, volume_mm3) in volumes_mm3.iter_mut().enumerate() {
            let [u, v] = [(k + 1) % 3, (k + 2) % 3];
            let twice = (b[u] - a[u]) * (c[v] - a[v]) - (b[v] - a[v]) * (c[u] - a[u]);
            *volume_mm3 += twice / 2.0 * (a[k] + b[k] + c[k]) / 3.0;
        }
    }
    let [least, most] =
        volumes_mm3.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(*v), b.max(*v)]);
    (most > least).then_some(Doubtful { volume_mm3: most - least, ..all })
}

fn along_axis(
    vertices: &[[f32; 3]],
    triangles: &[[u32; 3]],
    axis: usize,
    cause: &'static str,
) -> Option<Doubtful> {
    let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
    let all = Doubtful::around(cause, 0.0, triangles.iter().flatten().map(|&i| vertices[i as usize]));
    let low = [u, v].map(|k| f64::from(all.min[k]));
    let step = [0, 1].map(|i| (f64::from(all.max[[u, v][i]]) - low[i]) / LINES as f64);
    if !(step[0] > 0.0 && step[1] > 0.0) {
        return None;
    }
    // Off the middle of the cells, where few vertices are.
    let shift = [0.414_213_562, 0.618_033_989];
    let at = |i: usize, cell: usize| low[i] + (cell as f64 + shift[i]) * step[i];
    let mut hits: Vec<Vec<Hit>> = vec![Vec::new(); LINES * LINES];
    for triangle in triangles {
        let corners = triangle.map(|i| {
            let p = vertices[i as usize].map(f64::from);
            ([p[u], p[v]], p[axis], i)
        });
        let cells = |i: usize| {
            let x = corners.map(|c| (c.0[i] - low[i]) / step[i] - shift[i]);
            let first = x[0].min(x[1]).min(x[2]).ceil().max(0.0) as usize;
            first..((x[0].max(x[1]).max(x[2]).floor() + 1.0).max(0.0) as usize).min(LINES)
        };
        for i in cells(0) {
            for j in cells(1) {
                if let Some(hit) = hit(&corners, [at(0, i), at(1, j)]) {
                    hits[i * LINES + j].push(hit);
                }
            }
        }
    }
    let mut doubt = Doubtful { min: [f32::INFINITY; 3], max: [f32::NEG_INFINITY; 3], ..all };
    for (cell, hits) in hits.iter().enumerate() {
        let enters = hits.iter().filter(|hit| hit.1).count();
        if 2 * enters == hits.len() {
            continue;
        }
        let (from, to) =
            hits.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), h| (a.min(h.0), b.max(h.0)));
        // A single hit says nothing of how long the line is inside.
        let alone = hits.len() == 1;
        let (from, to) =
            if alone { (f64::from(all.min[axis]), f64::from(all.max[axis])) } else { (from, to) };
        doubt.volume_mm3 += (to - from) * step[0] * step[1];
        let mut corner = [0.0; 3];
        (corner[u], corner[v]) = (at(0, cell / LINES) as f32, at(1, cell % LINES) as f32);
        for end in [from, to] {
            corner[axis] = end as f32;
            extend(&mut doubt.min, &mut doubt.max, corner);
        }
    }
    (doubt.volume_mm3 > 0.0).then_some(doubt)
}

/// Where a line meets a facet, and whether it enters there. Of facets with a common edge exactly one is met.
fn hit(corners: &[([f64; 2], f64, u32); 3], at: [f64; 2]) -> Option<Hit> {
    // Twice the area beside an edge, computed from its lesser vertex, so that both facets get the same.
    let beside = |a: usize, b: usize| {
        let (p, q, sign) = if corners[a].2 < corners[b].2 { (a, b, 1.0) } else { (b, a, -1.0) };
        let (p, q) = (corners[p].0, corners[q].0);
        let area = (q[0] - p[0]) * (at[1] - p[1]) - (q[1] - p[1]) * (at[0] - p[0]);
        sign * if area == 0.0 { f64::MIN_POSITIVE } else { area }
    };
    let shares = [beside(1, 2), beside(2, 0), beside(0, 1)];
    let up = shares.iter().all(|s| *s > 0.0);
    if !up && !shares.iter().all(|s| *s < 0.0) {
        return None;
    }
    let sum: f64 = shares.iter().sum();
    let along = (0..3).map(|i| shares[i] / sum * corners[i].1).sum();
    Some((along, !up))
}

/// Whether a mesh has edges that cannot be trusted.
pub(super) fn is_broken(twins: &[u32], clashing: usize) -> bool {
    clashing > 0 || twins.contains(&NO_TWIN)
}
