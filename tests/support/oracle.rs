//! Sections of meshes, and an independent program's opinion of them.

use std::path::Path;

use parry3d::math::Vector;
use parry3d::query::IntersectResult;
use parry3d::shape::TriMesh;
use pathwright::geometry::Region;
use pathwright::mesh::Mesh;
use pathwright::profile::LayerSettings;
use pathwright::slice::{Cutter, Gaps, LayerSpan};

/// A layer cut at this height.
pub fn span(cut_mm: f64) -> LayerSpan {
    LayerSpan { index: 0, bottom_mm: cut_mm - 0.1, top_mm: cut_mm + 0.1, height_mm: 0.2, cut_mm }
}

/// The section of a mesh as the slicer finds it.
pub fn section(mesh: &Mesh, cut_mm: f64) -> (Region, Gaps) {
    Cutter::new(mesh, &[span(cut_mm)], &LayerSettings::default()).section(0)
}

/// Area of the plane section as `parry3d` finds it: its loops have any orientation and are assembled even-odd.
fn oracle_area(mesh: &Mesh, cut_mm: f64) -> Option<f64> {
    let points = mesh.vertices().iter().map(|v| Vector::from(v.map(|x| x as f32))).collect();
    let surface = TriMesh::new(points, mesh.triangles().to_vec()).ok()?;
    let IntersectResult::Intersect(lines) =
        surface.intersection_with_local_plane(Vector::Z, cut_mm as f32, 0.0)
    else {
        return None;
    };
    let mut next = vec![Vec::new(); lines.vertices().len()];
    for &[a, b] in lines.indices() {
        next[a as usize].push(b);
        next[b as usize].push(a);
    }
    let mut seen = vec![false; next.len()];
    let mut loops: Vec<Vec<[f64; 2]>> = Vec::new();
    for start in 0..next.len() {
        let (mut at, mut ring) = (start, Vec::new());
        while !seen[at] {
            seen[at] = true;
            let p = lines.vertices()[at];
            ring.push([f64::from(p.x), f64::from(p.y)]);
            match next[at].iter().find(|&&n| !seen[n as usize]) {
                Some(&n) => at = n as usize,
                None => break,
            }
        }
        if ring.len() > 2 {
            loops.push(ring);
        }
    }
    let edges = |ring: &[[f64; 2]]| {
        (0..ring.len()).map(|i| (ring[i], ring[(i + 1) % ring.len()])).collect::<Vec<_>>()
    };
    let inside = |ring: &[[f64; 2]], p: [f64; 2]| {
        let crosses = |(a, b): &([f64; 2], [f64; 2])| {
            (a[1] > p[1]) != (b[1] > p[1]) && p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
        };
        edges(ring).iter().filter(|e| crosses(e)).count() % 2 == 1
    };
    let area = |ring: &[[f64; 2]]| {
        edges(ring).iter().map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>().abs() / 2.0
    };
    let depth = |i: usize| (0..loops.len()).filter(|&j| j != i && inside(&loops[j], loops[i][0])).count();
    Some((0..loops.len()).map(|i| area(&loops[i]) * if depth(i) % 2 == 0 { 1.0 } else { -1.0 }).sum())
}

/// Heights spread over a mesh, away from its vertices.
fn heights(mesh: &Mesh, count: usize) -> Vec<f64> {
    let [min, max] = mesh.bounds();
    let mut levels: Vec<f64> = mesh.vertices().iter().map(|v| v[2]).collect();
    levels.sort_by(f64::total_cmp);
    let height = |i: usize| min[2] + (max[2] - min[2]) * (i as f64 + 0.5) / count as f64;
    let far = |z: &f64| {
        let at = levels.partition_point(|level| level < z);
        levels[at.saturating_sub(1)..(at + 1).min(levels.len())].iter().all(|level| (level - z).abs() > 1e-3)
    };
    (0..count).map(height).filter(far).collect()
}

/// Holds sections at so many heights against the other program's.
pub fn assert_agrees(mesh: &Mesh, count: usize, name: &str) {
    for z in heights(mesh, count) {
        let (ours, _) = section(mesh, z);
        if let Some(theirs) = oracle_area(mesh, z) {
            let (ours, allowed) = (ours.area_mm2(), 1e-3 * theirs + 0.01);
            assert!((ours - theirs).abs() <= allowed, "{name} at {z}: {ours} instead of {theirs}");
        }
    }
}

/// The same for a file, if what it holds has one meaning and is not too large.
pub fn assert_sections_agree(path: &Path) {
    let (mesh, report) = pathwright::mesh::load(path).unwrap();
    if report.shells == 1 && report.watertight && report.non_manifold_edges == 0 && report.triangles < 50_000
    {
        assert_agrees(&mesh, 7, &path.display().to_string());
    }
}
