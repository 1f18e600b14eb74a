//! Cells back to regions.

use super::bitmap::{Bitmap, Grid};
use geometry::{Region, Ring};

/// The outline of a set of cells, its steps smoothed: the ring runs through the middles of the cells' sides, which
/// cuts every corner by half a cell, and steps that are left are evened out.
///
/// Sets that are equal have equal outlines. O(cells).
pub fn trace(map: &Bitmap) -> Region {
    let grid = map.grid();
    let rings: Vec<Ring> = Edges::of(map).rings(grid);
    geometry::simplify(&geometry::unite_rings(&rings), SMOOTH * grid.cell_mm())
}

/// Vertices nearer than this to the outline without them are left out, in cells.
const SMOOTH: f64 = 0.35;

/// Directions of an edge, by quarter turns from the right.
const STEPS: [[i64; 2]; 4] = [[1, 0], [0, 1], [-1, 0], [0, -1]];

/// The sides of cells that have nothing on their other side, each running with its cell on the left.
struct Edges {
    /// For each corner of the grid, row by row, which directions leave it.
    leaving: Vec<u8>,
    columns: usize,
    starts: Vec<[usize; 2]>,
}

impl Edges {
    fn of(map: &Bitmap) -> Self {
        let [columns, rows] = map.grid().size();
        let mut edges =
            Self { leaving: vec![0; (columns + 1) * (rows + 1)], columns: columns + 1, starts: vec![] };
        for [x, y] in map.rim().cells() {
            let beside = |dx: usize, dy: usize| {
                // Wraps below zero to a cell that is not there.
                map.has([(x + dx).wrapping_sub(1), (y + dy).wrapping_sub(1)])
            };
            for (direction, corner, other) in [
                (0, [x, y], beside(1, 0)),
                (1, [x + 1, y], beside(2, 1)),
                (2, [x + 1, y + 1], beside(1, 2)),
                (3, [x, y + 1], beside(0, 1)),
            ] {
                if !other {
                    edges.leaving[corner[1] * edges.columns + corner[0]] |= 1 << direction;
                    edges.starts.push(corner);
                }
            }
        }
        edges
    }

    fn rings(mut self, grid: Grid) -> Vec<Ring> {
        let mut rings = Vec::new();
        for start in std::mem::take(&mut self.starts) {
            while let Some(first) = (0..4).find(|d| self.leaves(start, *d)) {
                rings.push(self.ring(start, first, grid));
            }
        }
        rings
    }

    fn leaves(&self, [x, y]: [usize; 2], direction: usize) -> bool {
        self.leaving[y * self.columns + x] >> direction & 1 == 1
    }

    /// Takes out one ring, as the middles of its edges. Where four edges meet it turns left, so that cells which share
    /// but a corner are apart.
    fn ring(&mut self, start: [usize; 2], first: usize, grid: Grid) -> Ring {
        let (mut at, mut direction) = (start, first);
        let mut ring = Ring::new();
        loop {
            self.leaving[at[1] * self.columns + at[0]] &= !(1 << direction);
            let half = [0, 1].map(|i| 2 * at[i] as i64 + STEPS[direction][i]);
            ring.push(grid.half_corner(half));
            at = [0, 1].map(|i| (at[i] as i64 + STEPS[direction][i]) as usize);
            let closes = |d: usize| at == start && d == first;
            let turns = [1, 0, 3].map(|turn| (direction + turn) % 4);
            match turns.into_iter().find(|&d| closes(d) || self.leaves(at, d)) {
                Some(next) if !closes(next) => direction = next,
                _ => return ring,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::{Bounds, Point};

    #[test]
    fn outlines_keep_their_area_and_holes() {
        let bounds = Bounds { min: Point::from_mm(0.0, 0.0), max: Point::from_mm(20.0, 20.0) };
        let mut map = Bitmap::empty(Grid::new(bounds, 0.0, 0.5));
        for row in 0..20 {
            map.set_run(row, 5, 25);
        }
        let hole = |x, y| (9..14).contains(&x) && (9..14).contains(&y);
        let mut ring = Bitmap::empty(map.grid());
        map.cells().filter(|&[x, y]| !hole(x, y)).for_each(|cell| ring.set(cell));
        let region = trace(&ring);
        assert_eq!(region.polygons().len(), 1);
        assert_eq!(region.polygons()[0].holes.len(), 1);
        assert!((region.area_mm2() - ring.area_mm2()).abs() < 0.02 * ring.area_mm2());
    }

    #[test]
    fn cells_that_share_a_corner_are_apart() {
        let bounds = Bounds { min: Point::from_mm(0.0, 0.0), max: Point::from_mm(20.0, 20.0) };
        let mut map = Bitmap::empty(Grid::new(bounds, 0.0, 0.5));
        for row in 0..8 {
            map.set_run(row, 0, 8);
            map.set_run(row + 8, 8, 16);
        }
        assert_eq!(trace(&map).polygons().len(), 2);
    }
}
