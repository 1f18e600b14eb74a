//! Which facet lies beyond which edge.
//!
//! Half-edge `3 t + k` runs from corner `k` of triangle `t` to the next corner.

use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use crate::parallel;

/// Triangles from which matching by two threads pays.
const PARALLEL: usize = 20_000;

/// Marks a half-edge without a partner.
pub(crate) const NO_TWIN: u32 = u32::MAX;

/// The half-edge's two ends.
#[inline]
pub(super) fn ends(triangles: &[[u32; 3]], half: u32) -> (u32, u32) {
    let triangle = triangles[half as usize / 3];
    let corner = half as usize % 3;
    (triangle[corner], triangle[if corner == 2 { 0 } else { corner + 1 }])
}

/// One side of an edge, as found by `for_each_edge`; sorts by the edge's greater vertex, then by half-edge.
#[derive(Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Side(u64);

impl Side {
    #[inline]
    fn new(from: u32, to: u32, half: u32) -> Self {
        Self(u64::from(from.max(to)) << 32 | u64::from(half) << 1 | u64::from(from > to))
    }

    #[inline]
    fn greater_vertex(self) -> u32 {
        (self.0 >> 32) as u32
    }

    /// The half-edge.
    #[inline]
    pub fn half(self) -> u32 {
        self.0 as u32 >> 1
    }

    /// The triangle.
    #[inline]
    pub fn triangle(self) -> u32 {
        self.half() / 3
    }

    /// Whether it runs from the greater vertex index to the smaller.
    #[inline]
    pub fn is_backward(self) -> bool {
        self.0 & 1 == 1
    }
}

/// Calls `visit` once for every edge with its sides, ascending by half-edge.
pub(super) fn for_each_edge(triangles: &[[u32; 3]], vertex_count: usize, visit: impl FnMut(&[Side])) {
    for_each_edge_from(triangles, 0..vertex_count as u32, visit);
}

/// As `for_each_edge`, for the edges whose smaller vertex lies in a range.
///
/// Counting sort by the smaller vertex, then a sort of each short bucket. O(triangles) for bounded vertex degree.
fn for_each_edge_from(triangles: &[[u32; 3]], vertices: Range<u32>, mut visit: impl FnMut(&[Side])) {
    let count = vertices.len();
    let bucket_of = |from: u32, to: u32| {
        let bucket = from.min(to).wrapping_sub(vertices.start) as usize;
        (bucket < count).then_some(bucket)
    };
    let mut start = vec![0u32; count + 2];
    for &[a, b, c] in triangles {
        for bucket in [bucket_of(a, b), bucket_of(b, c), bucket_of(c, a)].into_iter().flatten() {
            start[bucket + 2] += 1;
        }
    }
    for v in 2..start.len() {
        start[v] += start[v - 1];
    }
    // `start[bucket + 1]` is the bucket's next free index while filling, and its end when filled.
    let mut sorted = vec![Side::default(); start[count + 1] as usize];
    let mut half = 0;
    for &[a, b, c] in triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            if let Some(bucket) = bucket_of(from, to) {
                let next = &mut start[bucket + 1];
                sorted[*next as usize] = Side::new(from, to, half);
                *next += 1;
            }
            half += 1;
        }
    }
    for bucket in start.windows(2).take(count) {
        let bucket = &mut sorted[bucket[0] as usize..bucket[1] as usize];
        sort_bucket(bucket);
        bucket.chunk_by(|a, b| a.greater_vertex() == b.greater_vertex()).for_each(&mut visit);
    }
}

/// Insertion sort: buckets hold six entries on average.
#[inline]
fn sort_bucket(bucket: &mut [Side]) {
    if bucket.len() > 32 {
        bucket.sort_unstable();
        return;
    }
    for i in 1..bucket.len() {
        let entry = bucket[i];
        let mut j = i;
        while j > 0 && bucket[j - 1] > entry {
            bucket[j] = bucket[j - 1];
            j -= 1;
        }
        bucket[j] = entry;
    }
}

/// Partners of half-edges, and how well they match.
#[derive(Debug, Default)]
pub(super) struct Edges {
    /// For each half-edge the opposite one in the neighbouring facet, or `NO_TWIN`.
    pub twins: Vec<u32>,
    /// Edges with one facet.
    pub open: usize,
    /// Edges with more than two facets.
    pub non_manifold: usize,
    /// Edges whose two facets run along it in the same direction.
    pub clashing: usize,
}

impl Edges {
    /// Pairs forward half-edges with backward ones; where more than two facets meet, in the order of facets.
    pub fn new(triangles: &[[u32; 3]], vertex_count: usize) -> Self {
        let twins: Vec<AtomicU32> = (0..triangles.len() * 3).map(|_| AtomicU32::new(NO_TWIN)).collect();
        let match_from = |vertices| Self::match_from(triangles, vertices, &twins);
        let count = vertex_count as u32;
        // Every edge belongs to one range, so the two never write to the same element.
        let [a, b] = if triangles.len() < PARALLEL || parallel::threads() == 1 {
            [match_from(0..count), Self::default()]
        } else {
            parallel::join(|| match_from(0..count / 2), || match_from(count / 2..count)).into()
        };
        Self {
            twins: twins.into_iter().map(AtomicU32::into_inner).collect(),
            open: a.open + b.open,
            non_manifold: a.non_manifold + b.non_manifold,
            clashing: a.clashing + b.clashing,
        }
    }

    fn match_from(triangles: &[[u32; 3]], vertices: Range<u32>, twins: &[AtomicU32]) -> Self {
        let mut edges = Self::default();
        let pair = |a: Side, b: Side| {
            twins[a.half() as usize].store(b.half(), Relaxed);
            twins[b.half() as usize].store(a.half(), Relaxed);
        };
        for_each_edge_from(triangles, vertices, |sides| match *sides {
            [a, b] if a.is_backward() != b.is_backward() => pair(a, b),
            [_] => edges.open += 1,
            [_, _] => edges.clashing += 1,
            _ => {
                edges.non_manifold += 1;
                let forward = sides.iter().filter(|side| !side.is_backward());
                let backward = sides.iter().filter(|side| side.is_backward());
                forward.zip(backward).for_each(|(&a, &b)| pair(a, b));
            }
        });
        edges
    }
}

/// The two ends of every half-edge without a partner.
pub(super) fn open_halves<'a>(
    triangles: &'a [[u32; 3]],
    twins: &'a [u32],
) -> impl Iterator<Item = (u32, u32)> + 'a {
    (0..twins.len() as u32).filter(|&h| twins[h as usize] == NO_TWIN).map(|h| ends(triangles, h))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fan_around_one_vertex_is_matched_however_many_facets_it_has() {
        let count = 100;
        let fan: Vec<[u32; 3]> = (0..count).map(|i| [0, 1 + i, 1 + (i + 1) % count]).collect();
        let edges = Edges::new(&fan, count as usize + 1);
        assert_eq!((edges.open, edges.non_manifold, edges.clashing), (count as usize, 0, 0));
        assert!((0..count).all(|i| edges.twins[3 * i as usize + 2] == 3 * ((i + 1) % count)));
    }

    #[test]
    fn three_facets_at_an_edge_pair_two_of_them() {
        let edges = Edges::new(&[[0, 1, 2], [1, 0, 3], [0, 1, 4]], 5);
        assert_eq!((edges.open, edges.non_manifold), (6, 1));
        assert_eq!((edges.twins[0], edges.twins[3], edges.twins[6]), (3, 0, NO_TWIN));
    }

    #[test]
    fn matching_in_two_ranges_gives_the_twins_of_one() {
        let side = 120;
        let cell = |i: u32, j: u32| i % side * side + j % side;
        let torus: Vec<[u32; 3]> = (0..side * side)
            .flat_map(|n| {
                let (i, j) = (n / side, n % side);
                let [a, b, c, d] = [cell(i, j), cell(i + 1, j), cell(i + 1, j + 1), cell(i, j + 1)];
                [[a, b, c], [a, c, d]]
            })
            .collect();
        assert!(torus.len() > PARALLEL);
        let vertices = side * side;
        let whole: Vec<AtomicU32> = (0..torus.len() * 3).map(|_| AtomicU32::new(NO_TWIN)).collect();
        Edges::match_from(&torus, 0..vertices, &whole);
        let whole: Vec<u32> = whole.into_iter().map(AtomicU32::into_inner).collect();
        assert_eq!(Edges::new(&torus, vertices as usize).twins, whole);
    }
}
