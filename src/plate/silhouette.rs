//! Meshes seen from above, as bits: what of the bed they cover.

use geo::{ConvexHull, MultiPoint};

/// A bitmap of the bed on a square grid whose nodes lie at whole multiples of the cell; cell (i, j) reaches from node
/// (i, j) to the next.
///
/// All that is marked errs on the safe side: a cell counts as covered if anything of it is.
#[derive(Clone, Debug)]
pub(super) struct Bitmap {
    /// Cell of the first bit.
    i0: i64,
    j0: i64,
    rows: usize,
    /// Words of a row.
    words: usize,
    bits: Vec<u64>,
}

impl Bitmap {
    /// Cells `low..=high`, none covered.
    pub fn new(low: [i64; 2], high: [i64; 2]) -> Self {
        let count = |i: usize| (high[i] - low[i] + 1).max(0) as usize;
        let (rows, words) = (count(1), count(0).div_ceil(64));
        Self { i0: low[0], j0: low[1], rows, words, bits: vec![0; rows * words] }
    }

    /// What lies under triangles. O(triangles · rows of each).
    fn of(triangles: impl Iterator<Item = [[f64; 2]; 3]> + Clone, cell_mm: f64) -> Self {
        let index = |x: f64| (x / cell_mm).floor() as i64;
        let all = triangles.clone().flatten();
        let (low, high) = all.fold(([i64::MAX; 2], [i64::MIN; 2]), |(low, high), p| {
            ([0, 1].map(|i| low[i].min(index(p[i]))), [0, 1].map(|i| high[i].max(index(p[i]))))
        });
        if low[0] > high[0] {
            return Self::new([0; 2], [-1; 2]);
        }
        let mut map = Self::new(low, high);
        for triangle in triangles {
            let [y0, y1] =
                [f64::min, f64::max].map(|pick| triangle.iter().map(|p| p[1]).reduce(pick).unwrap_or(0.0));
            for j in index(y0)..=index(y1) {
                let band = [j as f64 * cell_mm, (j + 1) as f64 * cell_mm];
                if let Some([x0, x1]) = reach(triangle, band) {
                    map.cover(j, index(x0), index(x1));
                }
            }
        }
        map
    }

    /// Covers cells `first..=last` of a row, as far as they exist.
    fn cover(&mut self, j: i64, first: i64, last: i64) {
        let (first, last) = ((first - self.i0).max(0), (last - self.i0).min(64 * self.words as i64 - 1));
        if !(0..self.rows as i64).contains(&(j - self.j0)) || first > last {
            return;
        }
        let row = (j - self.j0) as usize * self.words;
        let (first, last) = (first as usize, last as usize);
        for word in first / 64..=last / 64 {
            let from = if word == first / 64 { first % 64 } else { 0 };
            let to = if word == last / 64 { last % 64 } else { 63 };
            self.bits[row + word] |= (u64::MAX >> (63 - to)) & (u64::MAX << from);
        }
    }

    /// Covers also what is nearer than `reach_mm` to a covered cell.
    fn grown(&self, reach_mm: f64, cell_mm: f64) -> Self {
        let reach = reach_mm / cell_mm;
        let pad = reach.ceil() as i64 + 1;
        let columns = 64 * self.words as i64;
        let mut grown = Self::new(
            [self.i0 - pad, self.j0 - pad],
            [self.i0 + columns - 1 + pad, self.j0 + self.rows as i64 - 1 + pad],
        );
        // Between two cells with n others between them lie n cells' widths.
        let apart = |d: i64| (d.abs() - 1).max(0) as f64;
        let widths: Vec<(i64, i64)> = (-pad..=pad)
            .filter(|&dj| apart(dj) <= reach)
            .map(|dj| (dj, 1 + (reach * reach - apart(dj) * apart(dj)).max(0.0).sqrt().floor() as i64))
            .collect();
        for row in 0..self.rows {
            for (first, last) in self.runs(row) {
                for &(dj, wide) in &widths {
                    grown.cover(self.j0 + row as i64 + dj, first - wide, last + wide);
                }
            }
        }
        grown
    }

    /// First and last cells of what is covered without a gap in a row.
    fn runs(&self, row: usize) -> Vec<(i64, i64)> {
        let words = &self.bits[row * self.words..(row + 1) * self.words];
        let covered = |i: usize| words[i / 64] >> (i % 64) & 1 == 1;
        let (mut runs, mut begun) = (Vec::new(), None);
        for i in 0..=64 * self.words {
            match (begun, i < 64 * self.words && covered(i)) {
                (None, true) => begun = Some(i),
                (Some(first), false) => {
                    runs.push((self.i0 + first as i64, self.i0 + i as i64 - 1));
                    begun = None;
                }
                _ => {}
            }
        }
        runs
    }

    /// Whether a cell is covered by both, the other moved by this many cells.
    pub fn meets(&self, other: &Self, [di, dj]: [i64; 2]) -> bool {
        self.each_word(other, [di, dj], |mine, theirs| self.bits[mine] & theirs == 0).is_err()
    }

    /// Covers what another covers, moved by this many cells.
    pub fn add(&mut self, other: &Self, [di, dj]: [i64; 2]) {
        let mut set = Vec::new();
        let _ = self.each_word(other, [di, dj], |mine, theirs| {
            set.push((mine, theirs));
            true
        });
        for (mine, theirs) in set {
            self.bits[mine] |= theirs;
        }
    }

    /// Hands out the other's words in this one's places, until one of them is refused.
    fn each_word(
        &self,
        other: &Self,
        [di, dj]: [i64; 2],
        mut visit: impl FnMut(usize, u64) -> bool,
    ) -> Result<(), ()> {
        let shift = other.i0 + di - self.i0;
        let (ahead, bits) = (shift.div_euclid(64), shift.rem_euclid(64) as u32);
        for (row, words) in other.bits.chunks(other.words.max(1)).enumerate() {
            let j = other.j0 + row as i64 + dj - self.j0;
            if !(0..self.rows as i64).contains(&j) {
                continue;
            }
            for (k, &word) in words.iter().enumerate().filter(|(_, word)| **word != 0) {
                let parts = [word << bits, if bits == 0 { 0 } else { word >> (64 - bits) }];
                for (part, at) in parts.into_iter().zip(ahead + k as i64..) {
                    let inside = part != 0 && (0..self.words as i64).contains(&at);
                    if inside && !visit(j as usize * self.words + at as usize, part) {
                        return Err(());
                    }
                }
            }
        }
        Ok(())
    }

    /// How many cells are covered.
    pub fn count(&self) -> u32 {
        self.bits.iter().map(|word| word.count_ones()).sum()
    }

    /// How far from node (0, 0) it reaches, in cells.
    pub fn reach(&self) -> i64 {
        let far = |low: i64, count: usize| low.abs().max((low + count as i64).abs());
        far(self.i0, 64 * self.words).max(far(self.j0, self.rows))
    }
}

/// Smallest and largest x of the part of a triangle with y in a band.
fn reach(triangle: [[f64; 2]; 3], [low, high]: [f64; 2]) -> Option<[f64; 2]> {
    let mut found: Option<[f64; 2]> = None;
    let mut take = |x: f64| found = Some(found.map_or([x; 2], |[x0, x1]| [x0.min(x), x1.max(x)]));
    for k in 0..3 {
        let (p, q) = (triangle[k], triangle[(k + 1) % 3]);
        if (low..=high).contains(&p[1]) {
            take(p[0]);
        }
        for y in [low, high] {
            if (p[1] < y) != (q[1] < y) {
                take(p[0] + (y - p[1]) / (q[1] - p[1]) * (q[0] - p[0]));
            }
        }
    }
    found
}

/// The area of the bed that bodies, given by their triangles, cover, and `reach_mm` around that; of the convex hull
/// of each where `convex`.
pub(super) fn silhouette<T: Iterator<Item = [[f64; 2]; 3]>>(
    bodies: impl Iterator<Item = T>,
    convex: bool,
    reach_mm: f64,
    cell_mm: f64,
) -> Bitmap {
    let triangles: Vec<[[f64; 2]; 3]> = if convex {
        bodies.flat_map(|body| hull_fan(body.flatten())).collect()
    } else {
        bodies.flatten().collect()
    };
    let bare = Bitmap::of(triangles.iter().copied(), cell_mm);
    if reach_mm > 0.0 { bare.grown(reach_mm, cell_mm) } else { bare }
}

/// The convex hull of points, as triangles around its first corner.
fn hull_fan(points: impl Iterator<Item = [f64; 2]>) -> Vec<[[f64; 2]; 3]> {
    let points: MultiPoint<f64> = points.map(|[x, y]| (x, y)).collect();
    let hull: Vec<[f64; 2]> = points.convex_hull().exterior().points().map(|p| [p.x(), p.y()]).collect();
    (2..hull.len()).map(|k| [hull[0], hull[k - 1], hull[k]]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn covered(map: &Bitmap) -> Vec<(i64, i64, i64)> {
        (0..map.rows)
            .flat_map(|r| map.runs(r).into_iter().map(move |(a, b)| (map.j0 + r as i64, a, b)))
            .collect()
    }

    #[test]
    fn every_cell_that_a_triangle_touches_is_covered() {
        let map = Bitmap::of([[[0.5, 0.5], [2.5, 0.5], [0.5, 2.5]]].into_iter(), 1.0);
        assert_eq!(covered(&map), [(0, 0, 2), (1, 0, 2), (2, 0, 1)]);
    }

    #[test]
    fn growing_reaches_everything_that_is_nearer() {
        let dot = Bitmap::of([[[0.1, 0.1], [0.2, 0.1], [0.1, 0.2]]].into_iter(), 1.0);
        assert_eq!(covered(&dot.grown(1.0, 1.0))[0], (-2, -1, 1));
        assert_eq!(dot.grown(0.0, 1.0).count(), 9, "neighbours may touch");
    }

    #[test]
    fn bitmaps_meet_where_they_share_a_cell() {
        let mut long = Bitmap::new([-100, 0], [100, 0]);
        long.cover(0, -90, -70);
        let mut dot = Bitmap::new([5, 5], [5, 5]);
        dot.cover(5, 5, 5);
        assert!(!long.meets(&dot, [0, -5]) && !long.meets(&dot, [-96, -5]));
        assert!(long.meets(&dot, [-95, -5]) && long.meets(&dot, [-75, -5]) && !long.meets(&dot, [-75, -4]));
        long.add(&dot, [60, -5]);
        assert_eq!(covered(&long), [(0, -90, -70), (0, 65, 65)]);
    }
}
