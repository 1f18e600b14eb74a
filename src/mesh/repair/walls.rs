//! Patches between edges at which more than two facets meet, turned each by itself.
//!
//! How often the surface winds around the space on both sides of a patch, counted along rays, tells which side is
//! outside (after Takayama et al., A simple method for correcting facet orientations in polygon meshes based on ray
//! casting, JCGT 3(4), 2014): nothing is outside nothing. Where patches coincide, rays do not decide; those are turned so
//! that as many facets run along an edge in one direction as in the other.

use parry3d::math::Vector;
use parry3d::query::{Ray, RayCast};
use parry3d::shape::TriMesh;

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

const DIRECTIONS: [[f32; 3]; 3] = [[0.36, 0.48, 0.8], [-0.6, 0.64, 0.48], [0.48, -0.36, -0.8]];

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
    let points = vertices.iter().map(|&p| Vector::from(p)).collect();
    let Ok(mesh) = TriMesh::new(points, triangles.to_vec()) else { return found };
    for (members, found) in members.iter_mut().zip(&mut found).filter(|(members, _)| !members.is_empty()) {
        let area = |t: u32| area_mm2(vertices, triangles[t as usize]);
        members.sort_by(|&a, &b| area(b).total_cmp(&area(a)).then(a.cmp(&b)));
        let (mut right, mut wrong, mut tried) = (0, 0, 0);
        for &t in members.iter().take(SAMPLES) {
            tried += 1;
            let facet = triangles[t as usize];
            let Some(up) = normal(vertices, facet).try_normalize(0.0) else { continue };
            let middle = facet.into_iter().map(|v| point(vertices, v)).sum::<Vec3>() / 3.0;
            let [front, back] = [OFF_MM, -OFF_MM].map(|off| winding(&mesh, middle + off * up));
            match (front, back) {
                (-1, 0) => wrong += 1,
                (front, back) if front >= 0 && back == front + 1 => right += 1,
                _ => {}
            }
        }
        if 3 * wrong >= 2 * tried {
            *found = Finding::Wrong;
        } else if 3 * right >= 2 * tried {
            *found = Finding::Right;
        }
    }
    found
}

/// How often the surface winds around a point: the middle of what three rays count.
fn winding(mesh: &TriMesh, at: Vec3) -> i32 {
    let origin = Vector::new(at.x as f32, at.y as f32, at.z as f32);
    let mut counts = DIRECTIONS.map(|direction| {
        let direction = Vector::from(direction);
        let ray = Ray::new(origin, direction);
        let near = mesh.bvh().leaves(|node| node.cast_ray(&ray, f32::MAX) < f32::MAX);
        near.map(|t| {
            let facet = mesh.triangle(t);
            match facet.cast_local_ray(&ray, f32::MAX, false) {
                Some(_) if facet.scaled_normal().dot(direction) > 0.0 => 1,
                Some(_) => -1,
                None => 0,
            }
        })
        .sum::<i32>()
    });
    counts.sort_unstable();
    counts[1]
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
