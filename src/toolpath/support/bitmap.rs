//! Areas as bits: one for each square cell of a grid over the plate.
//!
//! Supports need no better resolution than a bead's width, but unions, differences and offsets of many layers, one
//! after the other. On bits each of them is a pass over a few thousand words.

use std::ops::Range;

use geometry::{Bounds, DisjointSets, HatchEnd, HatchSegment, Point, Region};

/// Grids have at most so many cells along a side, unless asked for: a layer then has at most 128 kB.
const MOST_CELLS: f64 = 1024.0;

pub(super) const WORD: usize = 64;

/// Square cells over a rectangle of the bed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Lower left corner.
    pub(super) origin: Point,
    /// Side of a cell in grid units.
    pub(super) cell: i32,
    pub(super) columns: usize,
    pub(super) rows: usize,
}

impl Grid {
    /// Cells of at least `cell_mm` over a box and `margin_mm` around it.
    pub fn new(bounds: Bounds, margin_mm: f64, cell_mm: f64) -> Self {
        Self::of_at_most(MOST_CELLS, bounds, margin_mm, cell_mm)
    }

    /// The same with at most so many cells along a side.
    pub(crate) fn of_at_most(most_cells: f64, bounds: Bounds, margin_mm: f64, cell_mm: f64) -> Self {
        let (min, max) = (bounds.min.mm(), bounds.max.mm());
        let size_mm = [0, 1].map(|i| max[i] - min[i] + 2.0 * margin_mm);
        let cell_mm = cell_mm.max(size_mm[0] / most_cells).max(size_mm[1] / most_cells);
        let count = |mm: f64| (mm / cell_mm).ceil().max(1.0) as usize;
        Self {
            origin: Point::from_mm(min[0] - margin_mm, min[1] - margin_mm),
            cell: geometry::to_units(cell_mm).max(1),
            columns: count(size_mm[0]),
            rows: count(size_mm[1]),
        }
    }

    /// Side of a cell in millimetres.
    pub fn cell_mm(&self) -> f64 {
        geometry::to_mm(self.cell)
    }

    /// How many cells a length is, to the nearest.
    pub fn cells(&self, mm: f64) -> usize {
        (mm / self.cell_mm()).round().max(0.0) as usize
    }

    /// Columns and rows.
    pub fn size(&self) -> [usize; 2] {
        [self.columns, self.rows]
    }

    /// The cell that holds a point, if any does.
    pub fn cell_at(&self, p: Point) -> Option<[usize; 2]> {
        let along = |v: i32, from: i32| (i64::from(v) - i64::from(from)).div_euclid(i64::from(self.cell));
        let (x, y) = (along(p.x, self.origin.x), along(p.y, self.origin.y));
        let inside = (0..self.columns as i64).contains(&x) && (0..self.rows as i64).contains(&y);
        inside.then_some([x as usize, y as usize])
    }

    /// The part that a box and one more cell around it touch, its columns beginning with a word; and its first word and row.
    pub(super) fn part(&self, bounds: Bounds) -> ([usize; 2], Self) {
        let along = |v: i32, from: i32| (i64::from(v) - i64::from(from)).div_euclid(i64::from(self.cell));
        let span = |min: i32, max: i32, from: i32, count: usize| {
            let at = |cell: i64| cell.clamp(0, count as i64) as usize;
            at(along(min, from) - 1)..at(along(max, from) + 2)
        };
        let mut x = span(bounds.min.x, bounds.max.x, self.origin.x, self.columns);
        x.start -= x.start % WORD;
        let y = span(bounds.min.y, bounds.max.y, self.origin.y, self.rows);
        let moved = |from: i32, cells: usize| from + cells as i32 * self.cell;
        let origin = Point::new(moved(self.origin.x, x.start), moved(self.origin.y, y.start));
        ([x.start / WORD, y.start], Self { origin, columns: x.len(), rows: y.len(), ..*self })
    }

    /// The middle of a cell, in millimetres.
    pub fn middle_mm(&self, [x, y]: [usize; 2]) -> [f64; 2] {
        let [x0, y0] = self.origin.mm();
        [x0 + (x as f64 + 0.5) * self.cell_mm(), y0 + (y as f64 + 0.5) * self.cell_mm()]
    }

    /// How far a position lies inside the grid's edges, in millimetres; 0 outside.
    pub fn inside_mm(&self, [x, y]: [f64; 2]) -> f64 {
        let [x0, y0] = self.origin.mm();
        let [width, depth] = [self.columns, self.rows].map(|cells| cells as f64 * self.cell_mm());
        (x - x0).min(y - y0).min(x0 + width - x).min(y0 + depth - y).max(0.0)
    }

    /// A corner of cells, by doubled indices: odd ones are middles of sides.
    pub(super) fn half_corner(&self, [x, y]: [i64; 2]) -> Point {
        let at = |from: i32, half: i64| (i64::from(from) + half * i64::from(self.cell) / 2) as i32;
        Point::new(at(self.origin.x, x), at(self.origin.y, y))
    }

    /// The words that hold a run of columns of one row, and its bits in each.
    #[inline]
    pub(super) fn run(
        &self,
        row: usize,
        from: usize,
        to: usize,
    ) -> impl Iterator<Item = (usize, u64)> + use<> {
        let base = row * self.stride();
        words_of(from, to).map(move |(word, bits)| (base + word, bits))
    }

    pub(super) fn stride(&self) -> usize {
        self.columns.div_ceil(WORD)
    }
}

/// The words of a row that hold a run of columns, and its bits in each.
#[inline]
pub(super) fn words_of(from: usize, to: usize) -> impl Iterator<Item = (usize, u64)> {
    let mut x = from;
    std::iter::from_fn(move || {
        let end = to.min((x / WORD + 1) * WORD);
        let count = end.checked_sub(x).filter(|&count| count > 0)?;
        let (word, bits) = (x / WORD, u64::MAX >> (WORD - count) << (x % WORD));
        x = end;
        Some((word, bits))
    })
}

/// A set of cells.
#[derive(Clone, Debug)]
pub struct Bitmap {
    grid: Grid,
    /// Row by row, each from a new word on; bits beyond the last column are 0. None at all as long as there is no cell.
    words: Vec<u64>,
}

impl PartialEq for Bitmap {
    fn eq(&self, other: &Self) -> bool {
        self.grid == other.grid && (self.words == other.words || self.is_empty() && other.is_empty())
    }
}

impl Bitmap {
    /// No cell.
    pub fn empty(grid: Grid) -> Self {
        Self { grid, words: Vec::new() }
    }

    /// Its words, all of them.
    pub(super) fn words_mut(&mut self) -> &mut [u64] {
        self.words.resize(self.grid.stride() * self.grid.rows, 0);
        &mut self.words
    }

    /// Whether all of some bits of a word are set.
    #[inline]
    pub(super) fn holds(&self, word: usize, bits: u64) -> bool {
        self.words.get(word).is_some_and(|word| word & bits == bits)
    }

    /// The cells whose middles lie in a region.
    pub fn of(grid: Grid, region: &Region) -> Self {
        let mut map = Self::empty(grid);
        let cell_mm = grid.cell_mm();
        let phase_mm = geometry::to_mm(grid.origin.y) + cell_mm / 2.0;
        // Middles at or right of its start, left of its end.
        let column = |end: HatchEnd| {
            let half_cells = 2 * (i64::from(end.point.x) - i64::from(grid.origin.x)) + i64::from(grid.cell);
            (half_cells - 1).div_euclid(2 * i64::from(grid.cell)).clamp(0, grid.columns as i64) as usize
        };
        for HatchSegment { line, ends: [a, b] } in geometry::scan_lines(region, 0.0, cell_mm, phase_mm) {
            if let Some(row) = usize::try_from(line).ok().filter(|&row| row < grid.rows) {
                map.set_run(row, column(a), column(b));
            }
        }
        map
    }

    /// The cells that a region touches, at least those of its vertices.
    pub fn touching(grid: Grid, region: &Region) -> Self {
        let mut map = Self::of(grid, region);
        for ring in region.rings() {
            for cell in ring.iter().filter_map(|&p| grid.cell_at(p)) {
                map.set(cell);
            }
        }
        map
    }

    /// Its grid.
    pub fn grid(&self) -> Grid {
        self.grid
    }

    /// Whether there is no cell in it.
    pub fn is_empty(&self) -> bool {
        self.words.iter().all(|&w| w == 0)
    }

    /// Area of its cells in square millimetres.
    pub fn area_mm2(&self) -> f64 {
        let count: u32 = self.words.iter().map(|w| w.count_ones()).sum();
        f64::from(count) * self.grid.cell_mm().powi(2)
    }

    /// Whether a cell is in it; cells outside the grid are not.
    pub fn has(&self, [x, y]: [usize; 2]) -> bool {
        let inside = x < self.grid.columns && y < self.grid.rows;
        inside && self.holds(y * self.grid.stride() + x / WORD, 1 << (x % WORD))
    }

    /// Whether the cell at a position is in it.
    pub fn has_at(&self, p: Point) -> bool {
        self.grid.cell_at(p).is_some_and(|cell| self.has(cell))
    }

    /// Adds a cell of the grid.
    pub fn set(&mut self, [x, y]: [usize; 2]) {
        if x < self.grid.columns && y < self.grid.rows {
            let word = y * self.grid.stride() + x / WORD;
            self.words_mut()[word] |= 1 << (x % WORD);
        }
    }

    /// Adds a run of columns of one row.
    pub fn set_run(&mut self, row: usize, from: usize, to: usize) {
        let run = self.grid.run(row, from, to);
        let words = self.words_mut();
        run.for_each(|(word, bits)| words[word] |= bits);
    }

    /// Takes out the cells whose middles lie in a convex polygon.
    pub(crate) fn remove_convex(&mut self, ring: &[Point]) {
        let Grid { origin, cell, columns, rows } = self.grid;
        // In cells, from the middle of the first one on.
        let at = |v: i32, from: i32| (f64::from(v) - f64::from(from)) / f64::from(cell) - 0.5;
        let corners: Vec<[f64; 2]> = ring.iter().map(|p| [at(p.x, origin.x), at(p.y, origin.y)]).collect();
        let limit = |y: f64| y.clamp(0.0, rows as f64) as usize;
        let low = corners.iter().map(|[_, y]| *y).fold(f64::INFINITY, f64::min);
        let high = corners.iter().map(|[_, y]| *y).fold(f64::NEG_INFINITY, f64::max);
        let (first, end) = (limit(low.ceil()), limit(high.floor() + 1.0));
        if first >= end || self.words.is_empty() {
            return;
        }
        let mut spans = vec![[f64::INFINITY, f64::NEG_INFINITY]; end - first];
        for (a, b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
            let [[ax, ay], [bx, by]] = if a[1] <= b[1] { [*a, *b] } else { [*b, *a] };
            let slope = if by > ay { (bx - ax) / (by - ay) } else { 0.0 };
            for row in limit(ay.ceil()).max(first)..limit(by.floor() + 1.0).min(end) {
                let x = ax + slope * (row as f64 - ay);
                let [left, right] = &mut spans[row - first];
                (*left, *right) = (left.min(x), right.max(x));
            }
        }
        for (row, [left, right]) in (first..end).zip(spans) {
            let from = left.ceil().max(0.0) as usize;
            let to = (right.floor() + 1.0).clamp(0.0, columns as f64) as usize;
            self.grid.run(row, from, to).for_each(|(word, bits)| self.words[word] &= !bits);
        }
    }

    /// Takes out what hangs together, over corners too, in fewer cells than this.
    pub(crate) fn remove_small(&mut self, least: usize) {
        let all: Vec<[usize; 2]> = self.cells().collect();
        let mut rest = self.clone();
        let (mut ahead, mut part) = (Vec::new(), Vec::new());
        for cell in all {
            ahead.extend(rest.take(cell).then_some(cell));
            while let Some([x, y]) = ahead.pop() {
                part.push([x, y]);
                let beside = (0..9).map(|k| [(x + k % 3).wrapping_sub(1), (y + k / 3).wrapping_sub(1)]);
                ahead.extend(beside.filter(|&cell| rest.take(cell)));
            }
            if part.len() < least {
                for &cell in &part {
                    self.take(cell);
                }
            }
            part.clear();
        }
    }

    /// Takes out a cell; whether it was in it.
    fn take(&mut self, [x, y]: [usize; 2]) -> bool {
        let had = self.has([x, y]);
        if had {
            self.words[y * self.grid.stride() + x / WORD] &= !(1 << (x % WORD));
        }
        had
    }

    /// Its cells, row by row.
    pub fn cells(&self) -> impl Iterator<Item = [usize; 2]> + '_ {
        let stride = self.grid.stride();
        self.words.iter().enumerate().flat_map(move |(i, &word)| {
            let (y, first) = (i / stride, i % stride * WORD);
            std::iter::successors((word != 0).then_some(word), |w| Some(w & (w - 1)).filter(|&w| w != 0))
                .map(move |w| [first + w.trailing_zeros() as usize, y])
        })
    }

    /// The runs of cells side by side in a row.
    fn runs(&self, row: usize) -> impl Iterator<Item = Range<usize>> + '_ {
        let words = self.words.chunks(self.grid.stride().max(1)).nth(row).unwrap_or_default();
        // The first column from one on whose bit, after these are inverted, is 1.
        let next = |from: usize, inverted: u64| {
            let bits = |word: usize| words.get(word).map(|bits| bits ^ inverted);
            let mut found = bits(from / WORD).map(|bits| bits & u64::MAX << (from % WORD));
            let mut word = from / WORD;
            while found == Some(0) {
                word += 1;
                found = bits(word);
            }
            word * WORD + found.map_or(0, u64::trailing_zeros) as usize
        };
        let end = words.len() * WORD;
        let mut at = 0;
        std::iter::from_fn(move || {
            let from = next(at, 0);
            at = next(from, u64::MAX);
            (from < end).then_some(from..at)
        })
    }

    /// How many of its parts have no cell in another set of the same grid. A part hangs together over sides of cells.
    pub(crate) fn parts_apart(&self, others: &Self) -> usize {
        let mut parts = DisjointSets::default();
        let (mut runs, mut meet): (Vec<Range<usize>>, Vec<bool>) = (Vec::new(), Vec::new());
        let mut below = 0;
        for row in 0..self.grid.rows {
            let first = runs.len();
            for run in self.runs(row) {
                let own = runs.len() as u32;
                parts.push();
                // Those that end before it began touch no later one either.
                below += runs[below..first].iter().take_while(|under| under.end <= run.start).count();
                for (under, part) in runs[below..first].iter().zip(below as u32..) {
                    if under.start >= run.end {
                        break;
                    }
                    parts.join(part, own);
                }
                meet.push(
                    self.grid.run(row, run.start, run.end).any(|(word, bits)| others.meets(word, bits)),
                );
                runs.push(run);
            }
            below = first;
        }
        let (of, count) = parts.number();
        let mut apart = vec![true; count];
        of.iter().zip(meet).for_each(|(&part, meets)| apart[part as usize] &= !meets);
        apart.iter().filter(|apart| **apart).count()
    }

    /// Whether any of some bits of a word is set.
    fn meets(&self, word: usize, bits: u64) -> bool {
        self.words.get(word).is_some_and(|word| word & bits != 0)
    }

    /// Adds the cells of another set of the same grid.
    pub fn add(&mut self, other: &Self) {
        if !self.words.is_empty() {
            self.words.iter_mut().zip(&other.words).for_each(|(a, b)| *a |= b);
        } else if !other.is_empty() {
            self.words.clone_from(&other.words);
        }
    }

    /// Takes out the cells of another set of the same grid.
    pub fn remove(&mut self, other: &Self) {
        self.words.iter_mut().zip(&other.words).for_each(|(a, b)| *a &= !b);
    }

    /// Keeps what another set of the same grid has too.
    pub fn keep(&mut self, other: &Self) {
        if other.words.is_empty() {
            self.words.clear();
        }
        self.words.iter_mut().zip(&other.words).for_each(|(a, b)| *a &= b);
    }

    /// With everything within about this many cells: an octagon around each.
    pub fn grown(&self, cells: usize) -> Self {
        let mut map = self.clone();
        for step in 0..cells {
            let before = map.clone();
            map.merge(&before, [1, 0], |a, b| a | b);
            map.merge(&before, [-1, 0], |a, b| a | b);
            let upright = if step % 2 == 0 { before } else { map.clone() };
            map.merge(&upright, [0, 1], |a, b| a | b);
            map.merge(&upright, [0, -1], |a, b| a | b);
            map.mask();
        }
        map
    }

    /// The union of all squares of this many cells that fit; narrower parts vanish.
    pub fn opened(&self, side: usize) -> Self {
        let mut map = self.clone();
        for axis in [[-1, 0], [0, -1]] {
            map.swept(axis, side, |a, b| a & b);
        }
        for axis in [[1, 0], [0, 1]] {
            map.swept(axis, side, |a, b| a | b);
        }
        map
    }

    /// Merges it with itself moved by 1, 2, … `length` − 1 steps, in about log₂(length) passes.
    fn swept(&mut self, [right, up]: [isize; 2], length: usize, op: impl Fn(u64, u64) -> u64 + Copy) {
        let mut have = 1;
        while have < length {
            let step = have.min(length - have) as isize;
            let before = self.clone();
            self.merge(&before, [right * step, up * step], op);
            self.mask();
            have += step as usize;
        }
    }

    /// With gaps and holes filled that are narrower than about twice this many cells.
    pub fn closed(&self, cells: usize) -> Self {
        let mut map = self.grown(cells).shrunk(cells);
        map.add(self);
        map
    }

    /// Shrinks the cells by about this many; cells beyond the grid count as set.
    pub fn shrunk(&self, cells: usize) -> Self {
        self.inverted().grown(cells).inverted()
    }

    /// The cells that it does not have.
    fn inverted(&self) -> Self {
        let mut map = self.clone();
        map.words_mut().iter_mut().for_each(|word| *word = !*word);
        map.mask();
        map
    }

    /// Combines it, word by word, with another set of the same grid moved by this many cells, fewer than 64 to a side.
    /// Bits beyond the last column may be left over.
    fn merge(&mut self, other: &Self, [right, up]: [isize; 2], op: impl Fn(u64, u64) -> u64) {
        let stride = self.grid.stride();
        for (row, words) in self.words.chunks_exact_mut(stride).enumerate() {
            let from = (row as isize - up) as usize;
            let Some(source) = other.words.get(from.saturating_mul(stride)..).and_then(|w| w.get(..stride))
            else {
                words.iter_mut().for_each(|word| *word = op(*word, 0));
                continue;
            };
            let at = |column: usize| source.get(column).copied().unwrap_or(0);
            for (column, word) in words.iter_mut().enumerate() {
                let moved = match right {
                    0 => source[column],
                    1.. => source[column] << right | at(column.wrapping_sub(1)) >> (WORD as isize - right),
                    _ => source[column] >> -right | at(column + 1) << (WORD as isize + right),
                };
                *word = op(*word, moved);
            }
        }
    }

    /// The cells beside which, to a side, there is none.
    pub(super) fn rim(&self) -> Self {
        let mut inner = self.clone();
        for by in [[1, 0], [-1, 0], [0, 1], [0, -1]] {
            inner.merge(self, by, |a, b| a & b);
        }
        let mut rim = self.clone();
        rim.remove(&inner);
        rim
    }

    /// Clears the bits beyond the last column.
    pub(super) fn mask(&mut self) {
        let (stride, rest) = (self.grid.stride(), self.grid.columns % WORD);
        if rest > 0 {
            self.words.iter_mut().skip(stride - 1).step_by(stride).for_each(|w| *w &= (1 << rest) - 1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::Polygon;

    fn grid() -> Grid {
        Grid::new(Bounds { min: Point::from_mm(0.0, 0.0), max: Point::from_mm(40.0, 10.0) }, 0.0, 0.5)
    }

    fn square(x: f64, y: f64, side: f64) -> Region {
        let corner = |dx: f64, dy: f64| Point::from_mm(x + dx * side, y + dy * side);
        let outer = vec![corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)];
        Region::from(Polygon { outer, holes: Vec::new() })
    }

    #[test]
    fn a_region_has_the_cells_whose_middles_it_holds() {
        let map = Bitmap::of(grid(), &square(30.0, 2.0, 3.0));
        assert_eq!(map.area_mm2(), 9.0);
        assert!(map.has_at(Point::from_mm(32.9, 4.9)) && !map.has_at(Point::from_mm(33.1, 4.9)));
        assert_eq!(map.cells().count(), 36);
        assert!(map.cells().all(|cell| map.has(cell)));
        assert!(Bitmap::of(grid(), &square(5.3, 5.3, 0.1)).is_empty());
        assert_eq!(Bitmap::touching(grid(), &square(5.3, 5.3, 0.1)).cells().count(), 1);
    }

    #[test]
    fn parts_apart_are_those_that_no_walk_over_sides_of_cells_leads_from_to_the_others() {
        let mut random = geometry::Random::new(5);
        let grid = Grid { columns: 130, rows: 9, ..grid() };
        let mut some = |share: u32| {
            let mut map = Bitmap::empty(grid);
            let cells = (0..130).flat_map(|x| (0..9).map(move |y| [x, y]));
            cells.filter(|_| random.below(100) < share).for_each(|cell| map.set(cell));
            map
        };
        for share in [0, 5, 40, 60, 80, 100] {
            let (cells, others) = (some(share), some(2));
            let (mut rest, mut apart) = (cells.clone(), 0);
            for cell in cells.cells() {
                let mut ahead: Vec<[usize; 2]> = rest.take(cell).then_some(cell).into_iter().collect();
                let mut part = Vec::new();
                while let Some([x, y]) = ahead.pop() {
                    part.push([x, y]);
                    let beside = [[x + 1, y], [x.wrapping_sub(1), y], [x, y + 1], [x, y.wrapping_sub(1)]];
                    ahead.extend(beside.into_iter().filter(|&cell| rest.take(cell)));
                }
                apart += usize::from(!part.is_empty() && part.iter().all(|&cell| !others.has(cell)));
            }
            assert_eq!(cells.parts_apart(&others), apart, "{share}");
        }
    }

    #[test]
    fn a_convex_polygon_takes_out_the_cells_whose_middles_it_holds() {
        let all = Bitmap::of(grid(), &square(0.0, 0.0, 40.0));
        for k in 0..40 {
            let turn = f64::from(k) * 0.37;
            let corner = |i: i32| {
                let (angle, radius) = (turn + f64::from(i) * 1.7, 1.1 + 0.1 * f64::from(k));
                Point::from_mm(15.0 + radius * angle.cos(), 4.0 + 0.6 * radius * angle.sin())
            };
            let ring: Vec<Point> = (0..3).map(corner).collect();
            let (mut left, mut expected) = (all.clone(), all.clone());
            left.remove_convex(&ring);
            expected.remove(&Bitmap::of(grid(), &Region::from(Polygon { outer: ring, holes: Vec::new() })));
            assert_eq!(left, expected, "{k}");
        }
    }

    #[test]
    fn small_parts_are_taken_out() {
        let (mut both, wide) = (Bitmap::of(grid(), &square(10.0, 4.0, 1.0)), square(30.0, 2.0, 3.0));
        let wide = Bitmap::of(grid(), &wide);
        both.add(&wide);
        both.remove_small(4);
        assert_eq!(both.cells().count(), 4 + 36);
        both.remove_small(5);
        assert_eq!(both, wide);
    }

    #[test]
    fn growing_and_opening_know_what_is_wide() {
        let (wide, narrow) = (Bitmap::of(grid(), &square(30.0, 2.0, 3.0)), square(10.0, 4.0, 1.0));
        let mut both = Bitmap::of(grid(), &narrow);
        both.add(&wide);
        assert_eq!(both.opened(4), wide);
        assert_eq!(both.opened(2), both);
        assert_eq!(wide.grown(1).cells().count(), 36 + 4 * 6);
        assert_eq!(wide.grown(2).cells().count(), 10 * 10 - 4);
    }

    #[test]
    fn closing_fills_what_is_narrow_between() {
        let mut two = Bitmap::of(grid(), &square(10.0, 2.0, 4.0));
        two.add(&Bitmap::of(grid(), &square(15.0, 2.0, 4.0)));
        assert!(two.closed(1).has_at(Point::from_mm(14.5, 4.0)));
        assert!(two.closed(1).area_mm2() < 37.0);
        let mut far = Bitmap::of(grid(), &square(10.0, 2.0, 4.0));
        far.add(&Bitmap::of(grid(), &square(20.0, 2.0, 4.0)));
        assert_eq!(far.closed(2), far);
    }
}
