//! Sheets that hang on a surface: fins, and walls between bodies that touch.

use crate::mesh::edges::for_each_edge;
use crate::mesh::measure::{area_mm2, keep, length_mm};
use geometry::DisjointSets;

/// A patch between edges that do not have two facets.
#[derive(Clone, Copy)]
struct Patch {
    area_mm2: f64,
    rim_mm: f64,
    /// Rim with an odd number of facets, with three or more of them.
    shared_mm: f64,
    /// Without it, an edge that is closed now would be open.
    holds: bool,
}

/// Largest ratio of a sheet's area to the area that its rim could enclose in a plane; larger ones bulge.
const FLAT: f64 = 2.0;

/// A sheet hangs on something with this many times its area.
const LARGER: f64 = 1.5;

impl Patch {
    fn is_sheet(&self) -> bool {
        let flat_mm2 = self.rim_mm.powi(2) / (4.0 * std::f64::consts::PI);
        self.shared_mm > 0.0 && !self.holds && self.area_mm2 < FLAT * flat_mm2
    }
}

/// Drops patches without which every edge around them is closed, the smallest first. Patches end where there are not two
/// facets at an edge; one that touches no other is no sheet. Returns how many facets went. O(n) for each that goes.
pub(super) fn drop_sheets(
    vertices: &[[f32; 3]],
    triangles: &mut Vec<[u32; 3]>,
    free: &mut Vec<bool>,
) -> usize {
    let before = triangles.len();
    // Each round leaves fewer patches; meshes with many are not repaired so.
    for _ in 0..MOST_ROUNDS {
        let mut parts = DisjointSets::new(triangles.len());
        for_each_edge(triangles, vertices.len(), |sides| {
            if let [a, b] = *sides {
                parts.join(a.triangle(), b.triangle());
            }
        });
        let (patch_of, count) = parts.number();
        let mut patches = vec![Patch { area_mm2: 0.0, rim_mm: 0.0, shared_mm: 0.0, holds: false }; count];
        for (triangle, &patch) in triangles.iter().zip(&patch_of) {
            patches[patch as usize].area_mm2 += area_mm2(vertices, *triangle);
        }
        let mut neighbours: Vec<(u32, u32)> = Vec::new();
        for_each_edge(triangles, vertices.len(), |sides| {
            let own = |s: &crate::mesh::edges::Side| patch_of[s.triangle() as usize];
            if sides.len() == 2 {
                return;
            }
            let length_mm = length_mm(vertices, triangles, sides[0].half());
            for (i, side) in sides.iter().enumerate() {
                let patch = own(side);
                let here = sides.iter().filter(|other| own(other) == patch).count();
                let after = sides.len() - here;
                let p = &mut patches[patch as usize];
                p.rim_mm += length_mm;
                p.holds |= after % 2 == 1;
                // Also where a patch has two facets at the edge, as where a fin is bent round: it stays.
                p.shared_mm += if after > 0 && here % 2 == 1 { length_mm } else { 0.0 };
                neighbours.extend(sides[..i].iter().flat_map(|s| [(own(s), patch), (patch, own(s))]));
            }
        });
        neighbours.sort_unstable();
        neighbours.dedup();
        let beside = |patch: u32| {
            let first = neighbours.partition_point(|pair| pair.0 < patch);
            let near = neighbours[first..].iter().take_while(move |pair| pair.0 == patch);
            near.map(|pair| pair.1)
        };
        // A body full of holes has a long rim, too, but nothing larger beside it.
        let hangs = |patch: u32| {
            let own_mm2 = patches[patch as usize].area_mm2;
            beside(patch).any(|other| patches[other as usize].area_mm2 > LARGER * own_mm2)
        };
        let mut order: Vec<u32> = (0..count as u32).collect();
        order.retain(|&p| patches[p as usize].is_sheet() && hangs(p));
        order.sort_by(|&a, &b| {
            patches[a as usize].area_mm2.total_cmp(&patches[b as usize].area_mm2).then(a.cmp(&b))
        });
        // Of patches that share an edge only one may go in a round.
        let mut goes = vec![false; count];
        let mut kept = vec![false; count];
        for patch in order {
            if !kept[patch as usize] {
                goes[patch as usize] = true;
                for other in beside(patch) {
                    kept[other as usize] = true;
                }
            }
        }
        if !goes.contains(&true) {
            break;
        }
        let stays: Vec<bool> = patch_of.iter().map(|&patch| !goes[patch as usize]).collect();
        keep(free, &stays);
        keep(triangles, &stays);
    }
    before - triangles.len()
}

const MOST_ROUNDS: usize = 20;
