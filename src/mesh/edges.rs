//! Which facet lies beyond which edge.
//!
//! Half-edge `3 t + k` runs from corner `k` of triangle `t` to the next corner.

use std::ops::Range;

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
///
/// Counting sort by the smaller vertex, then a sort of each short bucket. O(triangles) for bounded vertex degree.
pub(super) fn for_each_edge(triangles: &[[u32; 3]], vertex_count: usize, mut visit: impl FnMut(&[Side])) {
    let mut start = vec![0u32; vertex_count + 2];
    for_each_half(triangles, |from, to, _| start[from.min(to) as usize + 2] += 1);
    add_up(&mut start);
    // `start[vertex + 1]` is the bucket's next free index while filling, and its end when filled.
    let mut sorted = vec![Side::default(); start[vertex_count + 1] as usize];
    for_each_half(triangles, |from, to, half| {
        let next = &mut start[from.min(to) as usize + 1];
        sorted[*next as usize] = Side::new(from, to, half);
        *next += 1;
    });
    for bucket in start.windows(2).take(vertex_count) {
        let bucket = &mut sorted[bucket[0] as usize..bucket[1] as usize];
        sort_bucket(bucket);
        bucket.chunk_by(|a, b| a.greater_vertex() == b.greater_vertex()).for_each(&mut visit);
    }
}

/// Calls `visit` with the two ends of every half-edge, and its number.
#[inline(always)]
fn for_each_half(triangles: &[[u32; 3]], mut visit: impl FnMut(u32, u32, u32)) {
    let mut half = 0;
    for &[a, b, c] in triangles {
        let corners = [a, b, c, a];
        for k in 0..3 {
            visit(corners[k], corners[k + 1], half);
            half += 1;
        }
    }
}

/// Makes each count the sum of those up to it.
fn add_up(counts: &mut [u32]) {
    for i in 1..counts.len() {
        counts[i] += counts[i - 1];
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
    /// How well they match.
    pub matches: Matches,
}

/// How well the facets at edges match.
#[derive(Debug, Default)]
pub(super) struct Matches {
    /// Edges with one facet.
    pub open: usize,
    /// Edges with more than two facets.
    pub non_manifold: usize,
    /// Edges whose two facets run along it in the same direction.
    pub clashing: usize,
    /// The facets at edges of the last two kinds, and perhaps others; some several times.
    pub crowded: Vec<u32>,
}

impl Edges {
    /// Pairs forward half-edges with backward ones; where more than two facets meet, in the order of facets.
    pub fn new(triangles: &[[u32; 3]], vertex_count: usize) -> Self {
        let match_from = |vertices| {
            let mut twins = vec![NO_TWIN; triangles.len() * 3];
            let matches = Matches::of_vertices(triangles, vertices, &mut twins);
            Self { twins, matches }
        };
        let count = vertex_count as u32;
        if triangles.len() < PARALLEL || parallel::threads() == 1 {
            return match_from(0..count);
        }
        let (mut a, b) = parallel::join(|| match_from(0..count / 2), || match_from(count / 2..count));
        // Every edge belongs to one range.
        for (own, &other) in a.twins.iter_mut().zip(&b.twins) {
            *own = other.min(*own);
        }
        a.matches.add(b.matches);
        a
    }

    /// The edges after some facets went, corners of others got other vertices, and new ones came: `now` has those of
    /// `before` that stay, and then the new ones. Only edges near what changed are matched.
    pub fn after(&self, before: &[[u32; 3]], stays: &[bool], now: &[[u32; 3]], vertex_count: usize) -> Self {
        let mut changed = vec![false; vertex_count];
        let mut mark = |facet: [u32; 3]| facet.into_iter().for_each(|v| changed[v as usize] = true);
        // How many half-edges went before each facet's.
        let mut gone = Vec::with_capacity(before.len());
        let mut next = 0;
        for (t, (&facet, &stays)) in before.iter().zip(stays).enumerate() {
            gone.push(3 * (t - next) as u32);
            if !stays {
                mark(facet);
                continue;
            }
            if now[next] != facet {
                mark(facet);
                mark(now[next]);
            }
            next += 1;
        }
        now[next..].iter().for_each(|&facet| mark(facet));

        let moved = |twin: u32| match twin {
            NO_TWIN => NO_TWIN,
            // Of facets that went only edges that are matched again know.
            twin => twin.wrapping_sub(gone[twin as usize / 3]),
        };
        let mut twins = Vec::with_capacity(3 * now.len());
        if next == before.len() {
            twins.extend_from_slice(&self.twins);
        } else {
            let kept = self.twins.as_chunks::<3>().0.iter().zip(stays).filter(|(_, stays)| **stays);
            kept.for_each(|(of_facet, _)| twins.extend_from_slice(&of_facet.map(moved)));
        }
        twins.resize(3 * now.len(), NO_TWIN);
        let left = Matches::among(before, |v| changed[v as usize], |_, _| {});
        let crowded = self.matches.crowded.iter().filter(|&&t| stays[t as usize]);
        let mut matches = Matches {
            open: self.matches.open - left.open,
            non_manifold: self.matches.non_manifold - left.non_manifold,
            clashing: self.matches.clashing - left.clashing,
            crowded: crowded.map(|&t| t - gone[t as usize] / 3).collect(),
        };
        matches.add(Matches::among(now, |v| changed[v as usize], |half, twin| twins[half as usize] = twin));
        Self { twins, matches }
    }
}

impl Matches {
    /// Whether all edges have two facets that agree.
    pub fn are_perfect(&self) -> bool {
        self.open + self.clashing + self.non_manifold == 0
    }

    fn add(&mut self, other: Self) {
        self.open += other.open;
        self.non_manifold += other.non_manifold;
        self.clashing += other.clashing;
        self.crowded.extend(other.crowded);
    }

    /// Matches the edges whose smaller vertex lies in a range.
    ///
    /// Forward half-edges by counting sort, backward ones looked up among them. Vertices with an edge that has not one of
    /// each are left to [`Self::among`]. O(triangles) for bounded vertex degree.
    fn of_vertices(triangles: &[[u32; 3]], vertices: Range<u32>, twins: &mut [u32]) -> Self {
        let count = vertices.len();
        let bucket_of = |vertex: u32| {
            let bucket = vertex.wrapping_sub(vertices.start) as usize;
            (bucket < count).then_some(bucket)
        };
        let mut start = vec![0u32; count + 2];
        for_each_half(triangles, |from, to, _| {
            if from < to
                && let Some(bucket) = bucket_of(from)
            {
                start[bucket + 2] += 1;
            }
        });
        add_up(&mut start);
        // `start[bucket + 1]` is the bucket's next free index while filling, and its end when filled.
        let mut forward = vec![(0, 0); start[count + 1] as usize];
        for_each_half(triangles, |from, to, half| {
            if from < to
                && let Some(bucket) = bucket_of(from)
            {
                let next = &mut start[bucket + 1];
                forward[*next as usize] = (to, half);
                *next += 1;
            }
        });
        let mut doubtful = vec![false; count];
        for (bucket, doubtful) in start.windows(2).zip(&mut doubtful) {
            let sides = &forward[bucket[0] as usize..bucket[1] as usize];
            *doubtful = sides.len() > FEW || repeats(sides);
        }
        let mut paired = 0;
        for_each_half(triangles, |from, to, half| {
            if from < to {
                return;
            }
            let Some(bucket) = bucket_of(to) else { return };
            let sides = &forward[start[bucket] as usize..start[bucket + 1] as usize];
            let mut other = None;
            for side in &sides[..sides.len().min(FEW)] {
                if side.0 == from {
                    other = Some(side.1);
                    break;
                }
            }
            match other {
                Some(other) if twins[other as usize] == NO_TWIN => {
                    twins[half as usize] = other;
                    twins[other as usize] = half;
                    paired += 1;
                }
                _ => doubtful[bucket] = true,
            }
        });
        if paired < forward.len() {
            for (bucket, doubtful) in start.windows(2).zip(&mut doubtful) {
                let mut sides = forward[bucket[0] as usize..bucket[1] as usize].iter();
                *doubtful |= sides.any(|side| twins[side.1 as usize] == NO_TWIN);
            }
        }
        if !doubtful.contains(&true) {
            return Self::default();
        }
        let is_doubtful = |vertex| bucket_of(vertex).is_some_and(|bucket| doubtful[bucket]);
        Self::among(triangles, is_doubtful, |half, twin| twins[half as usize] = twin)
    }

    /// Matches the edges whose smaller vertex is wanted: `set` gets their half-edges, each with its twin or `NO_TWIN`.
    fn among(triangles: &[[u32; 3]], wanted: impl Fn(u32) -> bool, mut set: impl FnMut(u32, u32)) -> Self {
        let mut sides: Vec<(u32, Side)> = Vec::new();
        for (&[a, b, c], half) in triangles.iter().zip((0..).step_by(3)) {
            // Few facets have any.
            if !(wanted(a) | wanted(b) | wanted(c)) {
                continue;
            }
            for (from, to, half) in [(a, b, half), (b, c, half + 1), (c, a, half + 2)] {
                let smaller = from.min(to);
                if wanted(smaller) {
                    sides.push((smaller, Side::new(from, to, half)));
                }
            }
        }
        sides.sort_unstable();
        let mut matches = Self::default();
        let edge = |&(smaller, side): &(u32, Side)| (smaller, side.greater_vertex());
        for sides in sides.chunk_by(|a, b| edge(a) == edge(b)) {
            let of = |backward| {
                let sides = sides.iter().filter(move |(_, side)| side.is_backward() == backward);
                sides.map(|(_, side)| side.half())
            };
            sides.iter().for_each(|(_, side)| set(side.half(), NO_TWIN));
            of(false).zip(of(true)).for_each(|(a, b)| {
                set(a, b);
                set(b, a);
            });
            match sides {
                [_] => matches.open += 1,
                [(_, a), (_, b)] if a.is_backward() != b.is_backward() => continue,
                [_, _] => matches.clashing += 1,
                _ => matches.non_manifold += 1,
            }
            if sides.len() > 1 {
                matches.crowded.extend(sides.iter().map(|(_, side)| side.triangle()));
            }
        }
        matches
    }
}

/// Half-edges at a vertex that are looked through one by one.
const FEW: usize = 32;

/// Whether two of some half-edges from one vertex lead to the same.
#[inline]
fn repeats(sides: &[(u32, u32)]) -> bool {
    for i in 1..sides.len() {
        for j in 0..i {
            if sides[j].0 == sides[i].0 {
                return true;
            }
        }
    }
    false
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
        assert_eq!(
            (edges.matches.open, edges.matches.non_manifold, edges.matches.clashing),
            (count as usize, 0, 0)
        );
        assert!((0..count).all(|i| edges.twins[3 * i as usize + 2] == 3 * ((i + 1) % count)));
    }

    #[test]
    fn three_facets_at_an_edge_pair_two_of_them() {
        let edges = Edges::new(&[[0, 1, 2], [1, 0, 3], [0, 1, 4]], 5);
        assert_eq!((edges.matches.open, edges.matches.non_manifold), (6, 1));
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
        let mut whole = vec![NO_TWIN; torus.len() * 3];
        Matches::of_vertices(&torus, 0..vertices, &mut whole);
        let threads = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
        assert_eq!(threads.install(|| Edges::new(&torus, vertices as usize)).twins, whole);
    }
}
