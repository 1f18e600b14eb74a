//! Facets as they come → shared vertices.

/// Coordinates beyond this (10 m) do not fit the integer grid with room for sums.
pub(super) const LIMIT_MM: f32 = 10_000.0;

/// Coordinates beyond this are no coordinates, in whatever unit: 10 m in micrometres, and far from the origin.
pub(super) const FARTHEST: f32 = 1e9;

/// Triangles over shared vertices, as read: nothing is known of their neighbourhood yet.
#[derive(Clone, Debug, Default)]
pub(super) struct Soup {
    pub vertices: Vec<[f32; 3]>,
    pub triangles: Vec<[u32; 3]>,
    /// Facets left out because two of their corners are equal.
    pub degenerate: usize,
}

/// Welds equal corners while facets arrive. O(1) each, by open addressing with linear probing.
///
/// Corners are looked up in batches: the first probes of a batch do not depend on each other, so that their cache misses
/// overlap, which halves the time on meshes larger than the cache.
pub(super) struct Welder {
    soup: Soup,
    /// Vertex indices, `EMPTY` where there is none; the size is a power of two, at most half full.
    table: Vec<u32>,
    /// Corners not looked up yet, three for each facet.
    batch: Vec<[f32; 3]>,
}

const EMPTY: u32 = u32::MAX;

/// Corners in a batch: a few kilobytes, so that it stays in the first-level cache.
const BATCH: usize = 3 * 64;

impl Welder {
    /// Room for as many vertices as a closed mesh of this many facets has (about half).
    pub fn with_capacity(facets: usize) -> Self {
        let soup = Soup {
            vertices: Vec::with_capacity(facets / 2 + 16),
            triangles: Vec::with_capacity(facets),
            degenerate: 0,
        };
        let table = vec![EMPTY; (facets + BATCH).next_power_of_two()];
        Self { soup, table, batch: Vec::with_capacity(BATCH) }
    }

    /// The facets of one soup, then those of another: vertices are numbered as if one welder had got them all.
    pub fn append(&mut self, other: Soup) {
        self.weld_batch();
        self.reserve(other.vertices.len());
        let mask = self.table.len() - 1;
        let index: Vec<u32> = other.vertices.iter().map(|&v| self.index(v, hash(v) & mask)).collect();
        self.soup.triangles.extend(other.triangles.iter().map(|t| t.map(|v| index[v as usize])));
        self.soup.degenerate += other.degenerate;
    }

    /// Adds a facet.
    ///
    /// # Errors
    /// The coordinate that is not finite or beyond [`FARTHEST`].
    #[inline]
    pub fn push(&mut self, corners: [[f32; 3]; 3]) -> Result<(), f32> {
        for &x in corners.as_flattened() {
            if x.is_nan() || x.abs() > FARTHEST {
                return Err(x);
            }
        }
        for [x, y, z] in corners {
            // Adding zero makes −0.0 into 0.0, so that equal numbers have equal bits.
            self.batch.push([x + 0.0, y + 0.0, z + 0.0]);
        }
        if self.batch.len() == BATCH {
            self.weld_batch();
        }
        Ok(())
    }

    /// What has been welded.
    pub fn finish(mut self) -> Soup {
        self.weld_batch();
        self.soup
    }

    fn weld_batch(&mut self) {
        self.reserve(self.batch.len());
        let mask = self.table.len() - 1;
        let mut slots = [0; BATCH];
        let mut found = [EMPTY; BATCH];
        let (batch, table, vertices) =
            (self.batch.as_slice(), self.table.as_slice(), self.soup.vertices.as_slice());
        for (i, &corner) in batch.iter().enumerate() {
            slots[i] = hash(corner) & mask;
            found[i] = table[slots[i]];
        }
        for (i, &corner) in batch.iter().enumerate() {
            let vertex = found[i] as usize;
            if vertex >= vertices.len() || !same(vertices[vertex], corner) {
                found[i] = EMPTY;
            }
        }
        for first in (0..self.batch.len()).step_by(3) {
            for i in first..first + 3 {
                if found[i] == EMPTY {
                    found[i] = self.index(self.batch[i], slots[i]);
                }
            }
            let [a, b, c] = [found[first], found[first + 1], found[first + 2]];
            if a == b || b == c || c == a {
                self.soup.degenerate += 1;
            } else {
                self.soup.triangles.push([a, b, c]);
            }
        }
        self.batch.clear();
    }

    /// The corner's vertex, new or old, probing from its slot.
    #[inline]
    fn index(&mut self, corner: [f32; 3], mut slot: usize) -> u32 {
        let mask = self.table.len() - 1;
        loop {
            let found = self.table[slot];
            if found == EMPTY {
                let index = self.soup.vertices.len() as u32;
                self.table[slot] = index;
                self.soup.vertices.push(corner);
                return index;
            }
            if same(self.soup.vertices[found as usize], corner) {
                return found;
            }
            slot = (slot + 1) & mask;
        }
    }

    /// Makes the table large enough for this many more vertices.
    fn reserve(&mut self, more: usize) {
        let size = ((self.soup.vertices.len() + more) * 2).next_power_of_two();
        if size <= self.table.len() {
            return;
        }
        self.table.clear();
        self.table.resize(size, EMPTY);
        for (index, &vertex) in self.soup.vertices.iter().enumerate() {
            let mut slot = hash(vertex) & (size - 1);
            while self.table[slot] != EMPTY {
                slot = (slot + 1) & (size - 1);
            }
            self.table[slot] = index as u32;
        }
    }
}

/// Equality of bits, in one branch.
#[inline(always)]
fn same(a: [f32; 3], b: [f32; 3]) -> bool {
    (a[0].to_bits() ^ b[0].to_bits()) | (a[1].to_bits() ^ b[1].to_bits()) | (a[2].to_bits() ^ b[2].to_bits())
        == 0
}

/// Multiplies the 96 bits into 64 (Fibonacci hashing) and takes the well-mixed upper half.
#[inline(always)]
fn hash(corner: [f32; 3]) -> usize {
    const ODD: u64 = 0x9E37_79B9_7F4A_7C15;
    let (x, y, z) =
        (u64::from(corner[0].to_bits()), u64::from(corner[1].to_bits()), u64::from(corner[2].to_bits()));
    let mixed = (x | (y << 32)).wrapping_mul(ODD);
    let mixed = (mixed ^ (mixed >> 32) ^ z).wrapping_mul(ODD);
    (mixed >> 32) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_corners_are_one_vertex_and_minus_zero_is_zero() {
        let mut welder = Welder::with_capacity(2);
        welder.push([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]).unwrap();
        welder.push([[-0.0, 0.0, -0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]).unwrap();
        let soup = welder.finish();
        assert_eq!(soup.triangles, [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn the_table_grows_with_a_soup_that_shares_nothing() {
        let mut welder = Welder::with_capacity(0);
        for i in 0..1000 {
            let x = i as f32;
            welder.push([[x, 0.0, 0.0], [x, 1.0, 0.0], [x, 0.0, 1.0]]).unwrap();
        }
        assert_eq!(welder.finish().vertices.len(), 3000);
    }

    #[test]
    fn coordinates_without_a_place_on_the_grid_are_refused() {
        for bad in [f32::NAN, f32::INFINITY, -1.1e9] {
            assert!(Welder::with_capacity(1).push([[0.0; 3], [bad, 0.0, 0.0], [1.0; 3]]).is_err());
        }
    }
}
