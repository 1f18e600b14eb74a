//! Which facet lies beyond which edge.
//!
//! Half-edge `3 t + k` runs from corner `k` of triangle `t` to the next corner.

/// Marks a half-edge without a partner.
pub(crate) const NO_TWIN: u32 = u32::MAX;

/// The half-edge's two ends.
#[inline]
pub(super) fn ends(triangles: &[[u32; 3]], half: u32) -> (u32, u32) {
    let triangle = triangles[half as usize / 3];
    let corner = half as usize % 3;
    (triangle[corner], triangle[if corner == 2 { 0 } else { corner + 1 }])
}

/// Calls `visit` once for every edge with its half-edges as `half << 1 | backward`, ascending; backward ones run from
/// the greater vertex index to the smaller.
///
/// Counting sort by the smaller vertex, then a sort of each short bucket. O(triangles) for bounded vertex degree.
pub(super) fn for_each_edge(triangles: &[[u32; 3]], vertex_count: usize, mut visit: impl FnMut(&[u32])) {
    let mut start = vec![0u32; vertex_count + 2];
    for &[a, b, c] in triangles {
        start[a.min(b) as usize + 2] += 1;
        start[b.min(c) as usize + 2] += 1;
        start[c.min(a) as usize + 2] += 1;
    }
    for v in 2..start.len() {
        start[v] += start[v - 1];
    }
    // `start[v + 1]` is the bucket's next free place while filling, and its end when filled.
    let mut sorted = vec![0u64; triangles.len() * 3];
    let mut half = 0u64;
    for &[a, b, c] in triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let place = &mut start[from.min(to) as usize + 1];
            sorted[*place as usize] = u64::from(from.max(to)) << 32 | half << 1 | u64::from(from > to);
            *place += 1;
            half += 1;
        }
    }
    let mut group: Vec<u32> = Vec::with_capacity(8);
    for v in 0..vertex_count {
        let bucket = &mut sorted[start[v] as usize..start[v + 1] as usize];
        sort_bucket(bucket);
        let mut rest = &*bucket;
        while let Some(&first) = rest.first() {
            let length = rest.iter().position(|e| e >> 32 != first >> 32).unwrap_or(rest.len());
            group.clear();
            group.extend(rest[..length].iter().map(|&e| e as u32));
            visit(&group);
            rest = &rest[length..];
        }
    }
}

/// Insertion sort: buckets hold six entries on average.
#[inline]
fn sort_bucket(bucket: &mut [u64]) {
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
        let mut edges = Self { twins: vec![NO_TWIN; triangles.len() * 3], ..Self::default() };
        for_each_edge(triangles, vertex_count, |group| match *group {
            [a, b] if (a ^ b) & 1 == 1 => edges.pair(a, b),
            [_] => edges.open += 1,
            [_, _] => edges.clashing += 1,
            _ => {
                edges.non_manifold += 1;
                let forward = group.iter().filter(|&&h| h & 1 == 0);
                let backward = group.iter().filter(|&&h| h & 1 == 1);
                for (&a, &b) in forward.zip(backward) {
                    edges.pair(a, b);
                }
            }
        });
        edges
    }

    fn pair(&mut self, a: u32, b: u32) {
        self.twins[a as usize >> 1] = b >> 1;
        self.twins[b as usize >> 1] = a >> 1;
    }
}
