//! Welding across gaps too small to print, where that closes open edges.

use rustc_hash::FxHashMap;

use super::edges::Edges;
use super::repair::open_halves;

/// Widths of gap to try, in millimetres, smallest first: the rounding of text files with three digits, and of models
/// that were exported in inches. A bead is forty times as wide.
const TOLERANCES_MM: [f32; 3] = [1e-4, 1e-3, 1e-2];

/// Triangles with fewer open edges; vertices that were merged into others are left over.
pub(super) struct Closed {
    pub triangles: Vec<[u32; 3]>,
    pub edges: Edges,
    /// Vertices merged into another.
    pub welded: usize,
    /// Facets that vanished because two of their corners were merged.
    pub collapsed: usize,
}

/// Merges vertices of open edges that lie within the tolerance of each other, or `None` where that closes nothing.
///
/// The smallest tolerance that leaves the fewest open edges wins. O(open edges), and one edge matching per tolerance.
pub(super) fn close(vertices: &[[f32; 3]], triangles: &[[u32; 3]], edges: &Edges) -> Option<Closed> {
    let mut rim: Vec<u32> = open_halves(triangles, &edges.twins).flat_map(|(a, b)| [a, b]).collect();
    rim.sort_unstable();
    rim.dedup();
    let mut best: Option<Closed> = None;
    for tolerance in TOLERANCES_MM {
        let (target, welded) = merge(vertices, &rim, tolerance);
        if welded == 0 {
            continue;
        }
        let mapped = triangles.iter().map(|t| t.map(|v| target[v as usize]));
        let kept: Vec<_> = mapped.filter(|&[a, b, c]| a != b && b != c && c != a).collect();
        let matched = Edges::new(&kept, vertices.len());
        if matched.open < best.as_ref().map_or(edges.open, |b| b.edges.open) {
            let collapsed = triangles.len() - kept.len();
            best = Some(Closed { triangles: kept, edges: matched, welded, collapsed });
        }
        if best.as_ref().is_some_and(|b| b.edges.open == 0) {
            break;
        }
    }
    best
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

fn neighbours(cell: [i64; 3]) -> impl Iterator<Item = [i64; 3]> {
    (0..27).map(move |i| [cell[0] + i % 3 - 1, cell[1] + i / 3 % 3 - 1, cell[2] + i / 9 - 1])
}

fn distance2(a: [f32; 3], b: [f32; 3]) -> f64 {
    (0..3).map(|i| (f64::from(a[i]) - f64::from(b[i])).powi(2)).sum()
}
