//! Cells that surely lie in a region, whatever rounding does.

use std::ops::Range;

use geometry::{Point, Region};

use super::bitmap::{Bitmap, Grid, WORD, words_of};

/// Cells so near to a boundary are no longer surely inside: 1 µm, in grid units.
const SLACK: i64 = 100;

impl Grid {
    /// Whether a function holds for all cells (rows, first column, one past the last) within [`SLACK`] of a segment: row by row, or
    /// of one that goes straight up at once. It does not for a segment that leaves the grid.
    fn holds_along(
        &self,
        a: Point,
        b: Point,
        mut holds: impl FnMut(Range<usize>, usize, usize) -> bool,
    ) -> bool {
        let (a, b) = if a.y <= b.y { (a, b) } else { (b, a) };
        let (left, bottom) = (i64::from(self.origin.x), i64::from(self.origin.y));
        let (ax, ay) = (i64::from(a.x) - left, i64::from(a.y) - bottom);
        let (bx, by) = (i64::from(b.x) - left, i64::from(b.y) - bottom);
        if ay <= SLACK || ax.min(bx) <= SLACK {
            return false;
        }
        let cell = i64::from(self.cell);
        // No two points are further apart than 2³² units.
        let cell_of = |along: i64| (along as u32 / self.cell as u32) as usize;
        let (first, last) = (cell_of(ay - SLACK), cell_of(by + SLACK));
        if last >= self.rows {
            return false;
        }
        let mut holds_in = |rows: Range<usize>, enter: i64, leave: i64| {
            let (from, to) = (cell_of(enter.min(leave) - SLACK), cell_of(enter.max(leave) + SLACK));
            to < self.columns && holds(rows, from, to + 1)
        };
        if ax == bx {
            return holds_in(first..last + 1, ax, ax);
        }
        let slope = if by > ay { (bx - ax) as f64 / (by - ay) as f64 } else { 0.0 };
        let at = |y: i64| match y {
            y if y <= ay => ax,
            y if y >= by => bx,
            y => ax + (slope * (y - ay) as f64) as i64,
        };
        (first..last + 1).all(|row| {
            let (low, high) = (row as i64 * cell - SLACK, (row as i64 + 1) * cell + SLACK);
            // A level segment is in one row at all its abscissae.
            let (enter, leave) = if low <= ay && by <= high { (ax, bx) } else { (at(low), at(high)) };
            holds_in(row..row + 1, enter, leave)
        })
    }

    /// Inverts, in every row whose middle a segment passes, the cell whose middle comes next after it.
    fn mark_passed(&self, a: Point, b: Point, words: &mut [u64]) {
        let (a, b) = if a.y <= b.y { (a, b) } else { (b, a) };
        let cell = i64::from(self.cell);
        // The first row whose middle is not below an ordinate.
        let row_over = |y: i32| {
            let up = i64::from(y) - i64::from(self.origin.y);
            (2 * up + cell - 1).div_euclid(2 * cell).clamp(0, self.rows as i64)
        };
        let (first, end) = (row_over(a.y), row_over(b.y));
        if first >= end {
            return;
        }
        let slope = (f64::from(b.x) - f64::from(a.x)) / (f64::from(b.y) - f64::from(a.y));
        let across = f64::from(a.x) - f64::from(self.origin.x);
        let column_at = |row: i64| {
            let up = i64::from(self.origin.y) - i64::from(a.y) + row * cell + cell / 2;
            ((across + slope * up as f64) / cell as f64 + 0.5).max(0.0) as usize
        };
        let mut column = column_at(first);
        for row in first..end {
            if a.x != b.x {
                column = column_at(row);
            }
            if column < self.columns {
                words[row as usize * self.stride() + column / WORD] ^= 1 << (column % WORD);
            }
        }
    }
}

/// The cells of a grid that surely lie in a region as a whole; none of a region that leaves the grid.
#[derive(Clone, Debug)]
pub(crate) struct Within {
    /// First word and row of those that are kept.
    first: [usize; 2],
    cells: Bitmap,
}

impl Within {
    /// Those in a region.
    pub fn of(grid: Grid, region: &Region) -> Self {
        let (first, grid) = grid.part(region.bounds().unwrap_or_default());
        let mut cells = Bitmap::empty(grid);
        let words = cells.words_mut();
        edges(region).for_each(|[a, b]| grid.mark_passed(a, b, words));
        for row in words.chunks_exact_mut(grid.stride().max(1)) {
            let mut inside = 0;
            for word in row {
                // Each bit becomes the parity of those up to it.
                let mut parity = *word;
                for step in [1, 2, 4, 8, 16, 32] {
                    parity ^= parity << step;
                }
                *word = parity ^ inside;
                inside = (*word >> (WORD - 1)).wrapping_neg();
            }
        }
        cells.mask();
        let words = cells.words_mut();
        let mut clear = |rows: Range<usize>, from: usize, to: usize| {
            for row in rows {
                grid.run(row, from, to).for_each(|(word, bits)| words[word] &= !bits);
            }
            true
        };
        let is_whole = edges(region).all(|[a, b]| grid.holds_along(a, b, &mut clear));
        Self { first, cells: if is_whole { cells } else { Bitmap::empty(grid) } }
    }

    /// Its cells, on the part of the grid where the region is.
    pub fn into_cells(self) -> Bitmap {
        self.cells
    }

    /// Whether the boundary of a region surely passes only cells that are in all of some sets of one grid.
    pub fn all_hold_boundary(grid: Grid, sets: &[&Self], region: &Region) -> bool {
        let holds = |rows: Range<usize>, from: usize, to: usize| {
            words_of(from, to).all(|(word, bits)| sets.iter().all(|set| set.holds(&rows, word, bits)))
        };
        edges(region).all(|[a, b]| grid.holds_along(a, b, holds))
    }

    /// Whether all of some bits of a word are in it in each of some of the grid's rows.
    #[inline]
    fn holds(&self, rows: &Range<usize>, word: usize, bits: u64) -> bool {
        let [first_word, first_row] = self.first;
        let (word, start) = (word.wrapping_sub(first_word), rows.start.wrapping_sub(first_row));
        let (grid, stride) = (self.cells.grid(), self.cells.grid().stride());
        word < stride
            && start < grid.rows
            && rows.len() <= grid.rows - start
            && (start..start + rows.len()).all(|row| self.cells.holds(row * stride + word, bits))
    }
}

/// The edges of a region's boundary.
fn edges(region: &Region) -> impl Iterator<Item = [Point; 2]> {
    region.rings().flat_map(|ring| {
        let before = ring.last().into_iter().chain(ring);
        before.zip(ring).map(|(&a, &b)| [a, b])
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::{Bounds, Polygon};

    fn ring(corners: &[(f64, f64)]) -> Vec<Point> {
        corners.iter().map(|&(x, y)| Point::from_mm(x, y)).collect()
    }

    /// A slanting frame.
    fn frame() -> Region {
        let outer = ring(&[(3.0, 1.0), (39.0, 4.03), (36.0, 30.0), (1.0, 27.0)]);
        Region::from(Polygon {
            outer,
            holes: vec![ring(&[(10.0, 10.0), (11.0, 20.0), (20.02, 21.0), (21.0, 9.0)])],
        })
    }

    #[test]
    fn cells_within_are_those_whose_corners_all_are_and_that_no_edge_passes() {
        let (grid, region) = (Grid::new(frame().bounds().unwrap(), 1.0, 0.4), frame());
        let within = Within::of(grid, &region);
        let [columns, rows] = grid.size();
        let corner = |x: usize, y: usize| grid.half_corner([2 * x as i64, 2 * y as i64]);
        let mut count = 0;
        for (x, y) in (0..columns).flat_map(|x| (0..rows).map(move |y| (x, y))) {
            let corners = [corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)];
            let whole = corners.iter().all(|&p| region.contains(p));
            let is_within = within.holds(&(y..y + 1), x / WORD, 1 << (x % WORD));
            assert!(!is_within || whole, "{x} {y}");
            count += usize::from(whole && !is_within);
        }
        // An edge passes between the corners of a cell at a corner of the hole, or so near to one that it may.
        assert!(count < 20, "{count} are missing");
        assert!(within.cells.cells().count() > 4000);
    }

    #[test]
    fn a_boundary_is_held_where_it_keeps_a_cell_away() {
        let grid = Grid::new(Bounds { min: Point::default(), max: Point::from_mm(40.0, 40.0) }, 1.0, 0.2);
        let within = Within::of(grid, &frame());
        let holds =
            |by_mm: f64| Within::all_hold_boundary(grid, &[&within], &geometry::offset(&frame(), by_mm));
        assert_eq!([-1.0, -0.6, -0.01, 0.0, 0.5].map(holds), [true, true, false, false, false]);
    }
}
