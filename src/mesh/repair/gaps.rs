//! Welding across gaps too small to print, where that closes open edges.

use rustc_hash::FxHashMap;

use crate::mesh::edges::{Edges, open_halves};

/// Widths of gap to try, in millimetres, smallest first: the rounding of text files with three digits, and of models
/// that were exported in inches. A bead is forty times as wide.
const TOLERANCES_MM: [f32; 3] = [1e-4, 1e-3, 1e-2];

/// Wider ones, which may close what was meant to be open, so that nearly all must close.
const WIDE_MM: [f32; 2] = [3e-2, 1e-1];

/// Of this many open edges one may stay open after a wide gap was closed.
const NEARLY_ALL: usize = 20;

/// Triangles with fewer open edges; vertices that were merged into others are left over.
pub(super) struct Closed {
    pub triangles: Vec<[u32; 3]>,
    pub edges: Edges,
    /// Vertices merged into another.
    pub welded: usize,
    /// How far they were moved on average, if that may be seen, mm.
    pub moved_mm: f64,
    /// Which of the facets are left: the others vanished because two of their corners were merged.
    pub stays: Vec<bool>,
}

/// Merges vertices of open edges that lie within the tolerance of each other, or `None` where that closes nothing.
///
/// The smallest tolerance that leaves the fewest open edges wins. O(triangles).
pub(super) fn close(vertices: &[[f32; 3]], triangles: &[[u32; 3]], edges: &Edges) -> Option<Closed> {
    let open: Vec<(u32, u32)> = open_halves(triangles, &edges.twins).collect();
    let mut rim: Vec<u32> = open.iter().flat_map(|&(a, b)| [a, b]).collect();
    rim.sort_unstable();
    rim.dedup();
    let merged = TOLERANCES_MM.map(|tolerance| merge(vertices, &rim, tolerance));
    let left = |(target, _): &(Vec<u32>, usize)| still_open(&open, target);
    let mut best = merged.into_iter().min_by_key(left)?;
    let mut moved_mm = 0.0;
    for tolerance in WIDE_MM {
        let (fewest, wide) = (left(&best), merge(vertices, &rim, tolerance));
        let wider = left(&wide);
        if fewest * NEARLY_ALL > open.len() && wider * NEARLY_ALL <= open.len() {
            moved_mm = mean_shift_mm(vertices, &wide.0);
            best = wide;
        }
    }
    let (target, welded) = best;
    if welded == 0 {
        return None;
    }
    let mapped = triangles.iter().map(|t| t.map(|v| target[v as usize]));
    let (mut kept, mut stays) = (Vec::with_capacity(triangles.len()), Vec::with_capacity(triangles.len()));
    for [a, b, c] in mapped {
        let stands = a != b && b != c && c != a;
        stays.push(stands);
        kept.extend(stands.then_some([a, b, c]));
    }
    let matched = edges.after(triangles, &stays, &kept, vertices.len());
    (matched.matches.open < edges.matches.open).then_some(Closed {
        triangles: kept,
        edges: matched,
        welded,
        moved_mm,
        stays,
    })
}

/// Edges that have one facet still, after merging.
fn still_open(open: &[(u32, u32)], target: &[u32]) -> usize {
    let mut facets: FxHashMap<(u32, u32), usize> = FxHashMap::default();
    for &(a, b) in open {
        let (a, b) = (target[a as usize], target[b as usize]);
        if a != b {
            *facets.entry((a.min(b), a.max(b))).or_default() += 1;
        }
    }
    facets.values().filter(|&&count| count == 1).count()
}

/// For each vertex the one it is merged into (mostly itself): the first rim vertex within the tolerance.
fn merge(vertices: &[[f32; 3]], rim: &[u32], tolerance: f32) -> (Vec<u32>, usize) {
    let mut target: Vec<u32> = (0..vertices.len() as u32).collect();
    let mut cells: FxHashMap<[i64; 3], Vec<u32>> = FxHashMap::default();
    let mut welded = 0;
    for &v in rim {
        let at = vertices[v as usize];
        let cell = at.map(|x| (f64::from(x) / f64::from(tolerance)).floor() as i64);
        let near = neighbours(cell).filter_map(|c| cells.get(&c)).flatten().copied();
        let found =
            near.filter(|&w| distance2(at, vertices[w as usize]) <= f64::from(tolerance).powi(2)).min();
        match found {
            Some(first) => {
                target[v as usize] = first;
                welded += 1;
            }
            None => cells.entry(cell).or_default().push(v),
        }
    }
    (target, welded)
}

/// How far vertices are from those that they are merged into, on average.
fn mean_shift_mm(vertices: &[[f32; 3]], target: &[u32]) -> f64 {
    let moved = || (0u32..).zip(target).filter(|(v, target)| *v != **target);
    let shift_mm: f64 =
        moved().map(|(v, &w)| distance2(vertices[v as usize], vertices[w as usize]).sqrt()).sum();
    shift_mm / moved().count().max(1) as f64
}

fn neighbours(cell: [i64; 3]) -> impl Iterator<Item = [i64; 3]> {
    (0..27).map(move |i| [cell[0] + i % 3 - 1, cell[1] + i / 3 % 3 - 1, cell[2] + i / 9 - 1])
}

fn distance2(a: [f32; 3], b: [f32; 3]) -> f64 {
    (0..3).map(|i| (f64::from(a[i]) - f64::from(b[i])).powi(2)).sum()
}
