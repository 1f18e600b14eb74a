//! Patches between edges at which more than two facets meet, turned each by itself.
//!
//! How often the surface winds around the space on both sides of a patch, counted along rays, tells which side is
//! outside (after Takayama et al., A simple method for correcting facet orientations in polygon meshes based on ray
//! casting, JCGT 3(4), 2014): nothing is outside nothing. Where patches coincide, rays do not decide; those are turned so
//! that as many facets run along an edge in one direction as in the other.

use std::cmp::Reverse;

use super::rays;
use crate::mesh::edges::{Side, for_each_edge};
use crate::mesh::measure::{Vec3, area_mm2, length_mm, normal, point};
use geometry::DisjointSets;

/// Points on each patch from which rays are cast.
const SAMPLES: usize = 3;

/// More patches than this are left as they are: each takes a few dozen rays.
const MOST_PATCHES: usize = 1000;

/// Points lie so far off their facet: no gap is narrower, as those were welded.
const OFF_MM: f64 = 2e-3;

/// Rounds of turning patches where that balances edges.
const ROUNDS: usize = 50;

/// The result of casting rays from a patch.
#[derive(Clone, Copy, PartialEq)]
enum Finding {
    Right,
    Wrong,
    Nothing,
}

/// An edge where more than two facets meet: its length, and the patches there with their direction.
struct Seam {
    length_mm: f64,
    sides: Vec<(u32, i32)>,
}

/// Turns patches that face inwards; returns how many facets were turned.
pub(super) fn turn_patches(vertices: &[[f32; 3]], triangles: &mut [[u32; 3]]) -> usize {
    let mut parts = DisjointSets::new(triangles.len());
    for_each_edge(triangles, vertices.len(), |sides| {
        if let [a, b] = *sides {
            parts.join(a.triangle(), b.triangle());
        }
    });
    let (patch_of, count) = parts.number();
    if !(2..=MOST_PATCHES).contains(&count) {
        return 0;
    }
    let mut seams = Vec::new();
    for_each_edge(triangles, vertices.len(), |sides| {
        if sides.len() > 2 {
            let direction =
                |s: &Side| (patch_of[s.triangle() as usize], if s.is_backward() { -1 } else { 1 });
            let length_mm = length_mm(vertices, triangles, sides[0].half());
            seams.push(Seam { length_mm, sides: sides.iter().map(direction).collect() });
        }
    });
    let found = findings(vertices, triangles, &patch_of, count, &seams);
    let mut turn: Vec<bool> = found.iter().map(|f| *f == Finding::Wrong).collect();
    balance(&seams, &found, &mut turn);
    let mut turned = 0;
    for (triangle, &patch) in triangles.iter_mut().zip(&patch_of) {
        if turn[patch as usize] {
            triangle.swap(1, 2);
            turned += 1;
        }
    }
    turned
}

/// What rays say of the patches at seams.
fn findings(
    vertices: &[[f32; 3]],
    triangles: &[[u32; 3]],
    patch_of: &[u32],
    count: usize,
    seams: &[Seam],
) -> Vec<Finding> {
    let mut found = vec![Finding::Nothing; count];
    let mut at_seam = vec![false; count];
    seams.iter().flat_map(|seam| &seam.sides).for_each(|&(patch, _)| at_seam[patch as usize] = true);
    let mut members: Vec<Vec<u32>> = vec![Vec::new(); count];
    for (t, &patch) in (0..).zip(patch_of).filter(|(_, patch)| at_seam[**patch as usize]) {
        members[patch as usize].push(t);
    }
    // Points before and behind facets of each patch; none for facets without area.
    let mut origins: Vec<[f32; 3]> = Vec::new();
    let mut sampled: Vec<(usize, Vec<Option<usize>>)> = Vec::new();
    for (patch, members) in members.into_iter().enumerate().filter(|(_, members)| !members.is_empty()) {
        let sample = |t: u32| {
            let facet = triangles[t as usize];
            let up = normal(vertices, facet).try_normalize(0.0)?;
            let middle = facet.into_iter().map(|v| point(vertices, v)).sum::<Vec3>() / 3.0;
            let first = origins.len();
            origins.extend([OFF_MM, -OFF_MM].map(|off| {
                let at = middle + off * up;
                [at.x as f32, at.y as f32, at.z as f32]
            }));
            Some(first)
        };
        sampled.push((patch, largest(members, vertices, triangles).into_iter().map(sample).collect()));
    }
    let windings = windings(vertices, triangles, &origins);
    for (patch, samples) in sampled {
        let (mut right, mut wrong) = (0, 0);
        for &first in samples.iter().flatten() {
            match (windings[first], windings[first + 1]) {
                (-1, 0) => wrong += 1,
                (front, back) if front >= 0 && back == front + 1 => right += 1,
                _ => {}
            }
        }
        if 3 * wrong >= 2 * samples.len() {
            found[patch] = Finding::Wrong;
        } else if 3 * right >= 2 * samples.len() {
            found[patch] = Finding::Right;
        }
    }
    found
}

/// The largest facets of a patch, of equal ones the first; so many as are sampled.
fn largest(members: Vec<u32>, vertices: &[[f32; 3]], triangles: &[[u32; 3]]) -> Vec<u32> {
    // Areas are no less than zero, and so ordered as their bits are.
    let area = |&t: &u32| area_mm2(vertices, triangles[t as usize]).to_bits();
    let mut by_size: Vec<(Reverse<u64>, u32)> = members.iter().map(|t| (Reverse(area(t)), *t)).collect();
    if by_size.len() > SAMPLES {
        by_size.select_nth_unstable(SAMPLES);
        by_size.truncate(SAMPLES);
    }
    by_size.sort_unstable();
    by_size.into_iter().map(|(_, t)| t).collect()
}

/// How often the surface winds around each point: the middle of what three rays count.
fn windings(vertices: &[[f32; 3]], triangles: &[[u32; 3]], points: &[[f32; 3]]) -> Vec<i32> {
    let mut counts = vec![[0; rays::COUNT]; points.len()];
    rays::for_each_hit(vertices, triangles, points, |hit| {
        counts[hit.ray.0][hit.ray.1] += if hit.leaves { 1 } else { -1 };
    });
    let middle = |mut counts: [i32; rays::COUNT]| {
        counts.sort_unstable();
        counts[rays::COUNT / 2]
    };
    counts.into_iter().map(middle).collect()
}

/// Turns patches of which rays say nothing where that balances more edges than it unbalances, the first ones first.
fn balance(seams: &[Seam], found: &[Finding], turn: &mut [bool]) {
    let mut around: Vec<Vec<usize>> = vec![Vec::new(); found.len()];
    for (i, seam) in seams.iter().enumerate() {
        for &(patch, _) in &seam.sides {
            if around[patch as usize].last() != Some(&i) {
                around[patch as usize].push(i);
            }
        }
    }
    let sum = |seam: &Seam, turn: &[bool]| -> i32 {
        seam.sides.iter().map(|&(patch, sign)| if turn[patch as usize] { -sign } else { sign }).sum()
    };
    for _ in 0..ROUNDS {
        let mut changed = false;
        for patch in (0..found.len()).filter(|&p| found[p] == Finding::Nothing) {
            let cost = |turn: &[bool]| -> f64 {
                let off = |&i: &usize| f64::from(sum(&seams[i], turn).abs()) * seams[i].length_mm;
                around[patch].iter().map(off).sum()
            };
            let before = cost(turn);
            turn[patch] ^= true;
            if cost(turn) < before - 1e-9 {
                changed = true;
            } else {
                turn[patch] ^= true;
            }
        }
        if !changed {
            break;
        }
    }
}
