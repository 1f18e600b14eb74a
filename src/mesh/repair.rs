//! Soup → mesh: duplicates dropped, small gaps welded, facets turned to face outwards.
//!
//! Each step runs only where edge matching shows that it is needed; holes, overlaps and self-intersections stay,
//! slicing copes with them.

use super::components::Components;
use super::edges::{Edges, NO_TWIN, ends, for_each_edge};
use super::gaps;
use super::outside;
use super::weld::Soup;

/// What was done and what was found; volume of an open shell: that of the cone from the middle of its box.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Repairs {
    pub degenerate: usize,
    pub duplicates: usize,
    pub welded: usize,
    pub flipped: usize,
    /// Holes of the size of one facet that were filled.
    pub filled: usize,
    /// Parts of which nearly as many facets faced in as out.
    pub doubtful: usize,
    pub open: usize,
    pub non_manifold: usize,
    /// Edges whose two facets could not be made to agree.
    pub clashing: usize,
    pub shells: usize,
    pub volume_mm3: f64,
    pub area_mm2: f64,
}

/// A mesh with its neighbourhood, coordinates as read.
pub(super) struct Repaired {
    pub vertices: Vec<[f32; 3]>,
    pub triangles: Vec<[u32; 3]>,
    pub twins: Vec<u32>,
    pub repairs: Repairs,
}

/// Repairs what can be repaired without guessing at shapes.
pub(super) fn repair(soup: Soup) -> Repaired {
    let Soup { mut vertices, mut triangles, mut degenerate } = soup;
    let mut repairs = Repairs::default();
    let mut edges = Edges::new(&triangles, vertices.len());
    // Two equal facets make three edges with two facets in the same direction.
    if edges.clashing + edges.non_manifold > 0 {
        repairs.duplicates = drop_duplicates(&mut triangles);
        if repairs.duplicates > 0 {
            edges = Edges::new(&triangles, vertices.len());
        }
    }
    if edges.open > 0
        && let Some(closed) = gaps::close(&vertices, &triangles, &edges)
    {
        repairs.welded = closed.welded;
        degenerate += closed.collapsed;
        (triangles, edges) = (closed.triangles, closed.edges);
    }
    if edges.clashing > 0 {
        (repairs.flipped, repairs.doubtful) = agree(&mut triangles, vertices.len());
        edges = Edges::new(&triangles, vertices.len());
    }
    if edges.open > 0 {
        let facets = missing_facets(&triangles, &edges);
        if !facets.is_empty() {
            repairs.filled = facets.len();
            triangles.extend(facets);
            edges = Edges::new(&triangles, vertices.len());
        }
    }
    if degenerate > 0 {
        drop_unused(&mut vertices, &mut triangles);
    }
    let (shell_of, shells) = shells(&triangles, vertices.len(), &edges);
    let outcome = outside::turn_outwards(&vertices, &mut triangles, &mut edges.twins, &shell_of, shells);
    repairs.flipped += outcome.turned;
    Repaired {
        repairs: Repairs {
            degenerate,
            open: edges.open,
            non_manifold: edges.non_manifold,
            clashing: edges.clashing,
            shells,
            volume_mm3: outcome.volume_mm3,
            area_mm2: outcome.area_mm2,
            ..repairs
        },
        vertices,
        triangles,
        twins: edges.twins,
    }
}

/// Drops facets that repeat another one, corner by corner in the same direction. Opposed ones stay: they are the wall
/// between two bodies that touch. O(n log n).
fn drop_duplicates(triangles: &mut Vec<[u32; 3]>) -> usize {
    let turned = |&[a, b, c]: &[u32; 3]| match a.min(b).min(c) {
        first if first == a => [a, b, c],
        first if first == b => [b, c, a],
        _ => [c, a, b],
    };
    let mut sorted: Vec<([u32; 3], usize)> = triangles.iter().map(turned).zip(0..).collect();
    sorted.sort_unstable();
    let mut repeated = vec![false; triangles.len()];
    for pair in sorted.windows(2) {
        repeated[pair[1].1] = pair[0].0 == pair[1].0;
    }
    let before = triangles.len();
    let mut repeated = repeated.into_iter();
    triangles.retain(|_| !repeated.next().unwrap_or(false));
    before - triangles.len()
}

/// Drops vertices that no facet names, which dropped facets leave behind.
fn drop_unused(vertices: &mut Vec<[f32; 3]>, triangles: &mut [[u32; 3]]) {
    let mut used = vec![false; vertices.len()];
    for &v in triangles.iter().flatten() {
        used[v as usize] = true;
    }
    let index: Vec<u32> = used
        .iter()
        .scan(0, |next, &used| {
            let index = *next;
            *next += u32::from(used);
            Some(index)
        })
        .collect();
    let mut used = used.into_iter();
    vertices.retain(|_| used.next().unwrap_or(false));
    for v in triangles.iter_mut().flatten() {
        *v = index[*v as usize];
    }
}

/// At a vertex with more open edges the rest are left alone: it is no mesh that can be mended, and must not take long.
const MOST_OPEN: usize = 64;

/// The facets that close holes of three edges. There is but one way to fill those, so nothing is guessed: a facet is
/// missing, or a neighbour's edge has a vertex on it that this facet's has not (a T-junction), and the facet has no
/// area. O(n log n) for n open edges.
fn missing_facets(triangles: &[[u32; 3]], edges: &Edges) -> Vec<[u32; 3]> {
    let mut open: Vec<(u32, u32)> = open_halves(triangles, &edges.twins).collect();
    open.sort_unstable();
    let from = |vertex: u32| {
        let first = open.partition_point(|half| half.0 < vertex);
        let fan = open[first..].iter().take(MOST_OPEN);
        fan.take_while(move |half| half.0 == vertex).map(|half| half.1)
    };
    let around = |&(a, b): &(u32, u32)| {
        let mut corners = from(b).filter(|&c| open.binary_search(&(c, a)).is_ok());
        // Where holes meet, an edge may belong to either of two.
        let c = corners.next().filter(|_| corners.next().is_none())?;
        (a < b && a < c).then_some([b, a, c])
    };
    open.iter().filter_map(around).collect()
}

/// A part is in doubt if its facets' majority is smaller than this share of them.
const CLEAR_MAJORITY: f64 = 0.2;

/// Turns facets so that neighbours agree across every edge with two facets; in each connected part the minority is
/// turned. Returns how many were turned, and in how many parts that was in doubt.
fn agree(triangles: &mut [[u32; 3]], vertex_count: usize) -> (usize, usize) {
    let mut parts = Components::new(triangles.len());
    for_each_edge(triangles, vertex_count, |sides| {
        if let [a, b] = *sides {
            // A part that cannot be oriented keeps the first relation found.
            parts.join(a.triangle(), b.triangle(), a.is_backward() == b.is_backward());
        }
    });
    let mut votes = vec![0i64; triangles.len()];
    let mut members = vec![0i64; triangles.len()];
    let sides: Vec<(u32, bool)> = (0..triangles.len() as u32).map(|t| parts.find(t)).collect();
    for &(root, opposed) in &sides {
        votes[root as usize] += if opposed { -1 } else { 1 };
        members[root as usize] += 1;
    }
    let mut turned = 0;
    for (triangle, &(root, opposed)) in triangles.iter_mut().zip(&sides) {
        if opposed == (votes[root as usize] >= 0) {
            triangle.swap(1, 2);
            turned += 1;
        }
    }
    let close = |(votes, members): &(i64, i64)| (votes.abs() as f64) < CLEAR_MAJORITY * *members as f64;
    (turned, votes.into_iter().zip(members).filter(close).count())
}

/// Numbers the parts that hang together by edges, in the order of their first facets.
fn shells(triangles: &[[u32; 3]], vertex_count: usize, edges: &Edges) -> (Vec<u32>, usize) {
    let mut parts = Components::new(triangles.len());
    for (half, &twin) in edges.twins.iter().enumerate() {
        if twin != NO_TWIN && (half as u32) < twin {
            parts.join(half as u32 / 3, twin / 3, false);
        }
    }
    if edges.non_manifold + edges.clashing > 0 {
        for_each_edge(triangles, vertex_count, |sides| {
            for pair in sides.windows(2) {
                parts.join(pair[0].triangle(), pair[1].triangle(), false);
            }
        });
    }
    parts.number()
}

/// The two ends of every half-edge without a partner.
pub(super) fn open_halves<'a>(
    triangles: &'a [[u32; 3]],
    twins: &'a [u32],
) -> impl Iterator<Item = (u32, u32)> + 'a {
    (0..twins.len() as u32).filter(|&h| twins[h as usize] == NO_TWIN).map(|h| ends(triangles, h))
}
