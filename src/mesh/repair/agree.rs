//! Facets turned so that neighbours agree on the outside.
//!
//! Facets that agree already are patches. Patches are joined across the edges where they clash, the longest common
//! rims first, and in each connected part the minority is turned. Two patches that are closed each but for a small rim
//! are bodies: an edge that they happen to have in common says nothing, each has its own outside.

use std::f64::consts::PI;

use rustc_hash::FxHashMap;

use crate::mesh::edges::{NO_TWIN, for_each_edge};
use crate::mesh::measure::{length_mm, normal, point};
use geometry::DisjointSets;

/// The facets that were flipped.
pub(super) struct Agreed {
    pub turned: usize,
    /// Facets of parts of which nearly as many faced in as out.
    pub doubtful: Vec<bool>,
}

/// A part is in doubt if its facets' majority is smaller than this share of them …
const CLEAR_MAJORITY: f64 = 0.2;

/// … than this share where another part is in doubt …
const CLEARER_MAJORITY: f64 = 0.5;

/// … or than this many times what it is by chance, as a standard deviation.
const CHANCE: f64 = 2.0;

/// A patch counts as closed if its area is this many times the area that its rim could enclose in a plane.
const CLOSED: f64 = 6.0;

#[derive(Clone, Copy, Default)]
struct Patch {
    area_mm2: f64,
    rim_mm: f64,
    volume_mm3: f64,
}

impl Patch {
    fn is_body(&self) -> bool {
        4.0 * PI * self.area_mm2 > CLOSED * self.rim_mm.powi(2)
    }
}

/// Turns facets; those marked as free have no vote and are not counted. O(n log n).
pub(super) fn agree(
    vertices: &[[f32; 3]],
    triangles: &mut [[u32; 3]],
    twins: &[u32],
    free: &[bool],
) -> Agreed {
    let mut parts = DisjointSets::new(triangles.len());
    let mut clashes = Vec::new();
    for_each_edge(triangles, vertices.len(), |sides| {
        if let [a, b] = *sides {
            if a.is_backward() == b.is_backward() {
                clashes.push((a.triangle(), b.triangle(), length_mm(vertices, triangles, a.half())));
            } else {
                parts.join(a.triangle(), b.triangle());
            }
        }
    });
    let (patch_of, count) = parts.number();
    let patches = measure(vertices, triangles, twins, &patch_of, count);
    let mut member = vec![0; count];
    for (t, &patch) in (0u32..).zip(&patch_of) {
        member[patch as usize] = t;
    }
    for (a, b, _) in rims(&clashes, &patch_of) {
        let (first, second) = (&patches[a as usize], &patches[b as usize]);
        let bodies = first.is_body() && second.is_body();
        let opposed = !bodies || (first.volume_mm3 > 0.0) != (second.volume_mm3 > 0.0);
        parts.join_opposed(member[a as usize], member[b as usize], opposed);
    }
    vote(triangles, &mut parts, free)
}

/// Pairs of patches with the length of the rim at which they clash, longest first.
fn rims(clashes: &[(u32, u32, f64)], patch_of: &[u32]) -> Vec<(u32, u32, f64)> {
    let mut index_of: FxHashMap<(u32, u32), usize> = FxHashMap::default();
    let mut rims: Vec<(u32, u32, f64)> = Vec::new();
    for &(a, b, length_mm) in clashes {
        let (a, b) = (patch_of[a as usize], patch_of[b as usize]);
        let (a, b) = (a.min(b), a.max(b));
        let at = *index_of.entry((a, b)).or_insert_with(|| {
            rims.push((a, b, 0.0));
            rims.len() - 1
        });
        rims[at].2 += length_mm;
    }
    rims.retain(|(a, b, _)| a != b);
    rims.sort_by(|x, y| y.2.total_cmp(&x.2).then((x.0, x.1).cmp(&(y.0, y.1))));
    rims
}

fn measure(
    vertices: &[[f32; 3]],
    triangles: &[[u32; 3]],
    twins: &[u32],
    patch_of: &[u32],
    count: usize,
) -> Vec<Patch> {
    let mut patches = vec![Patch::default(); count];
    // A point on each patch, so that rounding does not depend on where it is.
    let mut apex = vec![None; count];
    for (t, &patch) in patch_of.iter().enumerate() {
        let apex = *apex[patch as usize].get_or_insert(triangles[t][0]);
        let patch = &mut patches[patch as usize];
        let normal = normal(vertices, triangles[t]);
        patch.area_mm2 += normal.norm() / 2.0;
        patch.volume_mm3 += (point(vertices, triangles[t][0]) - point(vertices, apex)).dot(&normal) / 6.0;
        for (half, &twin) in (3 * t..).zip(&twins[3 * t..3 * t + 3]) {
            if twin == NO_TWIN || patch_of[twin as usize / 3] != patch_of[t] {
                patch.rim_mm += length_mm(vertices, triangles, half as u32);
            }
        }
    }
    patches
}

/// In each connected part the minority is turned.
fn vote(triangles: &mut [[u32; 3]], parts: &mut DisjointSets, free: &[bool]) -> Agreed {
    let mut votes = vec![0i64; triangles.len()];
    let mut members = vec![0i64; triangles.len()];
    let sides: Vec<(u32, bool)> = (0..triangles.len() as u32).map(|t| parts.find_opposed(t)).collect();
    for (&(root, opposed), &free) in sides.iter().zip(free) {
        let vote = if free { 0 } else { 1 };
        votes[root as usize] += if opposed { -vote } else { vote };
        members[root as usize] += vote;
    }
    let mut turned = 0;
    for ((triangle, &(root, opposed)), &free) in triangles.iter_mut().zip(&sides).zip(free) {
        if opposed == (votes[root as usize] >= 0) {
            triangle.swap(1, 2);
            turned += usize::from(!free);
        }
    }
    let close = |root: usize, clear: f64| {
        let (majority, members) = (votes[root].abs() as f64, members[root] as f64);
        majority < members && majority < (clear * members).max(CHANCE * members.sqrt())
    };
    // Where chance turned one part it may have turned others.
    let any = sides.iter().any(|&(root, _)| close(root as usize, CLEAR_MAJORITY));
    let clear = if any { CLEARER_MAJORITY } else { CLEAR_MAJORITY };
    Agreed { turned, doubtful: sides.iter().map(|&(root, _)| close(root as usize, clear)).collect() }
}
