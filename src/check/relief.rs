//! How high the print stands, on a grid of square cells over the bed.

use geometry::real;

use crate::gcode::Stroke;

/// A painted bead is wider by this much of a cell: cells count that it covers in part.
const OVER: f64 = 0.5 * 2.0;

/// Bits of a cell's fraction along a line.
const FRACTION: u32 = 32;

/// No grid has more cells: 16 MB.
const MOST_CELLS: f64 = 4e6;

/// Heights of the print in cells, mm. Those from the first to the last that is printed on are held: most of a bed never is.
#[derive(Clone, Debug, Default)]
struct Tops {
    first: usize,
    held_mm: Vec<f32>,
}

impl Tops {
    /// Minus infinity where nothing is.
    fn at(&self, cell: usize) -> f64 {
        let held_mm = self.held_mm.get(cell.wrapping_sub(self.first));
        held_mm.map_or(f64::NEG_INFINITY, |&top_mm| f64::from(top_mm))
    }

    fn raise(&mut self, cell: usize, z_mm: f32) {
        match self.held_mm.get_mut(cell.wrapping_sub(self.first)) {
            // Without a branch, which would be taken at random.
            Some(top_mm) => *top_mm = real::greater(z_mm, *top_mm),
            None => self.hold(cell, z_mm),
        }
    }

    /// Holds one more cell, and beyond it half as many as there are, so that this is seldom done.
    #[cold]
    fn hold(&mut self, cell: usize, z_mm: f32) {
        let more = self.held_mm.len() / 2;
        if self.held_mm.is_empty() {
            self.first = cell;
        }
        if cell < self.first {
            let first = cell.saturating_sub(more);
            self.held_mm.splice(0..0, std::iter::repeat_n(f32::NEG_INFINITY, self.first - first));
            self.first = first;
        } else {
            self.held_mm.resize(cell - self.first + more + 1, f32::NEG_INFINITY);
        }
        self.raise(cell, z_mm);
    }
}

/// Heights of what has been printed.
#[derive(Clone, Debug)]
pub(super) struct Relief {
    low: [f64; 2],
    cell_mm: f64,
    cells_per_mm: f64,
    columns: usize,
    rows: usize,
    /// The same as numbers that positions are compared with.
    size: [f64; 2],
    tops: Tops,
    highest_mm: f64,
    /// Where the last short bead ended.
    end: [f64; 3],
}

impl Relief {
    /// Cells of at least `cell_mm` over a rectangle, with nothing in them.
    pub fn new(low: [f64; 2], high: [f64; 2], cell_mm: f64) -> Self {
        let [width, depth] = [0, 1].map(|i| (high[i] - low[i]).max(cell_mm));
        let cell_mm = cell_mm.max((width * depth / MOST_CELLS).sqrt());
        let size = [width, depth].map(|mm| (mm / cell_mm).ceil());
        let [columns, rows] = size.map(|cells| cells as usize);
        let cells_per_mm = cell_mm.recip();
        let (tops, highest_mm, end) = (Tops::default(), f64::NEG_INFINITY, [f64::NAN; 3]);
        Self { low, cell_mm, cells_per_mm, columns, rows, size, tops, highest_mm, end }
    }

    /// Side of a cell.
    pub fn cell_mm(&self) -> f64 {
        self.cell_mm
    }

    /// Column and row at a position, with fractions; `None` beside the bed.
    fn cell_at(&self, [x, y, _]: [f64; 3]) -> Option<[f64; 2]> {
        let [column, row] = [(x - self.low[0]) * self.cells_per_mm, (y - self.low[1]) * self.cells_per_mm];
        let inside = column >= 0.0 && row >= 0.0 && column < self.size[0] && row < self.size[1];
        inside.then_some([column, row])
    }

    fn index(&self, at: [f64; 3]) -> Option<usize> {
        let [column, row] = self.cell_at(at)?.map(|along| along as u32 as usize);
        Some(row * self.columns + column)
    }

    /// How many cells there are.
    pub fn cell_count(&self) -> usize {
        self.columns * self.rows
    }

    /// Height of a cell; minus infinity where nothing is.
    pub fn top(&self, cell: usize) -> f64 {
        self.tops.at(cell)
    }

    /// Raises a cell.
    pub fn raise_cell(&mut self, cell: usize, z_mm: f64) {
        self.tops.raise(cell, z_mm as f32);
        self.highest_mm = self.highest_mm.max(z_mm);
    }

    /// The cells beside a cell, four at most.
    pub fn neighbours(&self, cell: usize) -> impl Iterator<Item = usize> {
        let (column, columns, count) = (cell % self.columns, self.columns, self.cell_count());
        let near = [
            (column > 0).then(|| cell - 1),
            (column + 1 < columns).then(|| cell + 1),
            cell.checked_sub(columns),
            (cell + columns < count).then(|| cell + columns),
        ];
        near.into_iter().flatten()
    }

    /// Calls `visit` for each cell whose middle is under a bead, with the height of the bead there. Beads that rise or turn
    /// are taken in short pieces, whose cells may come more than once.
    pub fn each_cell(&self, bead: &Stroke, width_mm: f64, mut visit: impl FnMut(usize, f64)) {
        let radius_mm = (width_mm / 2.0).max(self.cell_mm / 2.0);
        if bead.arc.is_none() && bead.from[2] == bead.to[2] {
            return self.capsule(bead.from, bead.to, radius_mm, |cell| visit(cell, bead.to[2]));
        }
        let count = self.samples(bead);
        let mut from = bead.from;
        for i in 1..=count {
            let to = bead.at(f64::from(i) / f64::from(count));
            self.capsule(from, to, radius_mm, |cell| visit(cell, to[2]));
            from = to;
        }
    }

    /// Calls `visit` for each cell whose middle is within the radius of a line, row by row.
    fn capsule(&self, from: [f64; 3], to: [f64; 3], radius_mm: f64, mut visit: impl FnMut(usize)) {
        let [dx, dy] = [to[0] - from[0], to[1] - from[1]];
        let length_mm = real::hypot(dx, dy);
        let across = match length_mm > 0.0 {
            true => [-dy / length_mm * radius_mm, dx / length_mm * radius_mm],
            false => [0.0; 2],
        };
        // The sides of the bead; its ends are round.
        let sides = [across, across.map(|x| -x)]
            .map(|[ax, ay]| [[from[0] + ax, from[1] + ay], [to[0] + ax, to[1] + ay]]);
        let ends = [[sides[0][0], sides[1][0]], [sides[0][1], sides[1][1]]];
        let row_of = |y: f64| (y - self.low[1]) * self.cells_per_mm - 0.5;
        let (low, high) = (from[1].min(to[1]) - radius_mm, from[1].max(to[1]) + radius_mm);
        let (first, last) = (row_of(low).ceil().max(0.0), row_of(high).floor().min(self.rows as f64 - 1.0));
        // A position that is not a number covers nothing.
        if first.is_nan() || last.is_nan() || first > last {
            return;
        }
        for row in first as usize..=last as usize {
            let y = self.low[1] + (row as f64 + 0.5) * self.cell_mm;
            let mut reach = [f64::INFINITY, f64::NEG_INFINITY];
            let mut take = |x: f64| reach = [reach[0].min(x), reach[1].max(x)];
            for end in [from, to] {
                let half2 = radius_mm * radius_mm - (y - end[1]) * (y - end[1]);
                if half2 >= 0.0 {
                    let half = half2.sqrt();
                    take(end[0] - half);
                    take(end[0] + half);
                }
            }
            for [p, q] in sides.into_iter().chain(ends) {
                if (p[1] <= y) != (q[1] <= y) {
                    take(p[0] + (y - p[1]) / (q[1] - p[1]) * (q[0] - p[0]));
                }
            }
            let column_of = |x: f64| (x - self.low[0]) * self.cells_per_mm - 0.5;
            let (first, last) = (
                column_of(reach[0]).ceil().max(0.0),
                column_of(reach[1]).floor().min(self.columns as f64 - 1.0),
            );
            if first <= last {
                (first as usize..=last as usize).for_each(|column| visit(row * self.columns + column));
            }
        }
    }

    /// Height at a position; minus infinity where nothing is.
    pub fn at(&self, x: f64, y: f64) -> f64 {
        self.index([x, y, 0.0]).map_or(f64::NEG_INFINITY, |index| self.tops.at(index))
    }

    /// Raises the cell at a position.
    fn raise(&mut self, at: [f64; 3]) {
        if let Some(index) = self.index(at) {
            self.tops.raise(index, at[2] as f32);
        }
    }

    /// Raises the cells under a bead's middle line.
    pub fn lay(&mut self, bead: &Stroke) {
        let highest_mm = bead.from[2].max(bead.to[2]);
        self.highest_mm = self.highest_mm.max(highest_mm);
        if bead.arc.is_none() && bead.xy_mm <= self.cell_mm {
            if bead.from != self.end {
                self.raise(bead.from);
            }
            self.end = bead.to;
            return self.raise(bead.to);
        }
        let count = self.samples(bead);
        match self.cell_at(bead.from).zip(self.cell_at(bead.to)) {
            Some((from, to)) if bead.arc.is_none() && bead.from[2] == bead.to[2] => {
                self.raise_between(from, to, count, highest_mm as f32);
            }
            _ => (0..=count).for_each(|i| self.raise(bead.at(f64::from(i) / f64::from(count)))),
        }
    }

    /// Raises the cells at both ends of a line, columns and rows, and at `count` − 1 positions between, to one height.
    fn raise_between(&mut self, from: [f64; 2], to: [f64; 2], count: u32, z_mm: f32) {
        // Fixed point; what is cut off keeps steps between the ends.
        const ONE: f64 = (1_u64 << FRACTION) as f64;
        let mut at = from.map(|cells| (cells * ONE) as i64);
        let step = [0, 1].map(|axis| ((to[axis] - from[axis]) * ONE / f64::from(count)) as i64);
        for _ in 0..count + 1 {
            let [column, row] = at.map(|cells| (cells >> FRACTION) as usize);
            self.tops.raise(row * self.columns + column, z_mm);
            at = [at[0] + step[0], at[1] + step[1]];
        }
    }

    /// Raises all cells under a bead.
    pub fn paint(&mut self, bead: &Stroke, width_mm: f64) {
        let mut tops = std::mem::take(&mut self.tops);
        self.each_cell(bead, width_mm + OVER * self.cell_mm, |cell, z_mm| tops.raise(cell, z_mm as f32));
        self.tops = tops;
        self.highest_mm = self.highest_mm.max(bead.from[2]).max(bead.to[2]);
    }

    /// Depth of a move below the print in its path, and the first position deeper than `slack_mm`.
    pub fn dip(&self, travel: &Stroke, slack_mm: f64) -> Option<([f64; 3], f64)> {
        if travel.from[2].min(travel.to[2]) >= self.highest_mm - slack_mm {
            return None;
        }
        let count = self.samples(travel);
        (0..=count).find_map(|i| {
            let point = travel.at(f64::from(i) / f64::from(count));
            let depth_mm = self.at(point[0], point[1]) - point[2];
            (depth_mm > slack_mm).then_some((point, depth_mm))
        })
    }

    /// A cell is passed at most once between two positions.
    fn samples(&self, travel: &Stroke) -> u32 {
        // As a count, what is not a number is 0.
        let most = 4 * (self.columns + self.rows) as u32;
        ((travel.xy_mm / self.cell_mm) as u32).min(most) + 1
    }
}
