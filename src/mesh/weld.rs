//! Facets as they come → shared vertices.

/// Coordinates beyond this (10 m) do not fit the integer grid with room for sums.
pub(super) const LIMIT_MM: f32 = 10_000.0;

/// Triangles over shared vertices, as read: nothing is known of their neighbourhood yet.
#[derive(Debug, Default)]
pub(super) struct Soup {
    pub vertices: Vec<[f32; 3]>,
    pub triangles: Vec<[u32; 3]>,
    /// Facets left out because two of their corners are equal.
    pub degenerate: usize,
}

/// Welds equal corners while facets arrive. O(1) each, by open addressing with linear probing.
pub(super) struct Welder {
    soup: Soup,
    /// Vertex indices, `EMPTY` where there is none; the size is a power of two, at most half full.
    table: Vec<u32>,
}

const EMPTY: u32 = u32::MAX;

impl Welder {
    /// Room for as many vertices as a closed mesh of so many facets has (about half).
    pub fn with_capacity(facets: usize) -> Self {
        let soup = Soup {
            vertices: Vec::with_capacity(facets / 2 + 16),
            triangles: Vec::with_capacity(facets),
            degenerate: 0,
        };
        Self { soup, table: vec![EMPTY; (facets + 16).next_power_of_two()] }
    }

    /// Adds a facet.
    ///
    /// # Errors
    /// The coordinate that is not finite or beyond 10 m.
    #[inline]
    pub fn push(&mut self, corners: [[f32; 3]; 3]) -> Result<(), f32> {
        let [a, b, c] = corners;
        let triangle = [self.index(a)?, self.index(b)?, self.index(c)?];
        if triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0] {
            self.soup.degenerate += 1;
        } else {
            self.soup.triangles.push(triangle);
        }
        Ok(())
    }

    /// What has been welded.
    pub fn finish(self) -> Soup {
        self.soup
    }

    #[inline]
    fn index(&mut self, corner: [f32; 3]) -> Result<u32, f32> {
        // Adding zero makes −0.0 into 0.0, so that equal numbers have equal bits.
        let corner = corner.map(|x| x + 0.0);
        let inside = |x: f32| x.abs() <= LIMIT_MM;
        if !(inside(corner[0]) & inside(corner[1]) & inside(corner[2])) {
            return Err(corner.into_iter().find(|&x| !inside(x)).unwrap_or(f32::NAN));
        }
        let mask = self.table.len() - 1;
        let mut slot = hash(corner) & mask;
        loop {
            let found = self.table[slot];
            if found == EMPTY {
                break;
            }
            if self.soup.vertices[found as usize] == corner {
                return Ok(found);
            }
            slot = (slot + 1) & mask;
        }
        let index = self.soup.vertices.len() as u32;
        self.table[slot] = index;
        self.soup.vertices.push(corner);
        if self.soup.vertices.len() * 2 > self.table.len() {
            self.grow();
        }
        Ok(index)
    }

    #[cold]
    fn grow(&mut self) {
        let size = self.table.len() * 2;
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

/// Multiplies the 96 bits into 64 (Fibonacci hashing) and takes the well-mixed upper half.
#[inline]
fn hash(corner: [f32; 3]) -> usize {
    const ODD: u64 = 0x9E37_79B9_7F4A_7C15;
    let [x, y, z] = corner.map(|v| u64::from(v.to_bits()));
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
        for bad in [f32::NAN, f32::INFINITY, -1.1e4] {
            assert!(Welder::with_capacity(1).push([[0.0; 3], [bad, 0.0, 0.0], [1.0; 3]]).is_err());
        }
    }
}
