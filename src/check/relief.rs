//! How high the print stands, on a grid of square cells over the bed.

use crate::gcode::Stroke;

/// No grid has more cells: 16 MB.
const MOST_CELLS: f64 = 4e6;

/// Heights of what has been printed.
#[derive(Clone, Debug)]
pub(super) struct Relief {
    low: [f64; 2],
    cell_mm: f64,
    cells_per_mm: f64,
    columns: usize,
    rows: usize,
    /// Top of what lies in each cell, mm; minus infinity where nothing does.
    tops_mm: Vec<f32>,
    highest_mm: f64,
    /// Where the last short bead ended.
    end: [f64; 3],
}

impl Relief {
    /// Cells of at least `cell_mm` over a rectangle, with nothing in them.
    pub fn new(low: [f64; 2], high: [f64; 2], cell_mm: f64) -> Self {
        let [width, depth] = [0, 1].map(|i| (high[i] - low[i]).max(cell_mm));
        let cell_mm = cell_mm.max((width * depth / MOST_CELLS).sqrt());
        let [columns, rows] = [width, depth].map(|mm| (mm / cell_mm).ceil() as usize);
        let tops_mm = vec![f32::NEG_INFINITY; columns * rows];
        let cells_per_mm = cell_mm.recip();
        let (highest_mm, end) = (f64::NEG_INFINITY, [f64::NAN; 3]);
        Self { low, cell_mm, cells_per_mm, columns, rows, tops_mm, highest_mm, end }
    }

    /// Side of a cell.
    pub fn cell_mm(&self) -> f64 {
        self.cell_mm
    }

    fn index(&self, x: f64, y: f64) -> Option<usize> {
        let (column, row) = ((x - self.low[0]) * self.cells_per_mm, (y - self.low[1]) * self.cells_per_mm);
        let inside = column >= 0.0 && row >= 0.0 && column < self.columns as f64 && row < self.rows as f64;
        inside.then(|| row as usize * self.columns + column as usize)
    }

    /// Height at a place; minus infinity where nothing is.
    pub fn at(&self, x: f64, y: f64) -> f64 {
        self.index(x, y).map_or(f64::NEG_INFINITY, |index| f64::from(self.tops_mm[index]))
    }

    /// Raises the cell at a place.
    pub fn raise(&mut self, x: f64, y: f64, z_mm: f64) {
        if let Some(index) = self.index(x, y) {
            let top = &mut self.tops_mm[index];
            *top = top.max(z_mm as f32);
            self.highest_mm = self.highest_mm.max(z_mm);
        }
    }

    /// Raises the cells under a bead's middle line.
    pub fn lay(&mut self, bead: &Stroke) {
        if bead.arc.is_none() && bead.xy_mm <= self.cell_mm {
            if bead.from != self.end {
                self.raise(bead.from[0], bead.from[1], bead.from[2]);
            }
            self.end = bead.to;
            return self.raise(bead.to[0], bead.to[1], bead.to[2]);
        }
        let count = self.places(bead);
        if bead.arc.is_some() {
            for i in 0..=count {
                let [x, y, z] = bead.at(f64::from(i) / f64::from(count));
                self.raise(x, y, z);
            }
            return;
        }
        let step = [0, 1, 2].map(|i| (bead.to[i] - bead.from[i]) / f64::from(count));
        let mut at = bead.from;
        for _ in 0..=count {
            self.raise(at[0], at[1], at[2]);
            at = [at[0] + step[0], at[1] + step[1], at[2] + step[2]];
        }
    }

    /// Raises all cells under a bead.
    pub fn paint(&mut self, bead: &Stroke, width_mm: f64) {
        let radius_mm = width_mm / 2.0;
        let reach = (radius_mm / self.cell_mm).ceil() as i32;
        let count = self.places(bead);
        for i in 0..=count {
            let [x, y, z] = bead.at(f64::from(i) / f64::from(count));
            for column in -reach..=reach {
                for row in -reach..=reach {
                    let (dx, dy) = (f64::from(column) * self.cell_mm, f64::from(row) * self.cell_mm);
                    if dx.hypot(dy) <= radius_mm {
                        self.raise(x + dx, y + dy, z);
                    }
                }
            }
        }
    }

    /// How far a move dips below what stands on its way, and where: the first place deeper than `slack_mm`.
    pub fn dip(&self, way: &Stroke, slack_mm: f64) -> Option<([f64; 3], f64)> {
        if way.from[2].min(way.to[2]) >= self.highest_mm - slack_mm {
            return None;
        }
        let count = self.places(way);
        (0..=count).find_map(|i| {
            let place = way.at(f64::from(i) / f64::from(count));
            let depth_mm = self.at(place[0], place[1]) - place[2];
            (depth_mm > slack_mm).then_some((place, depth_mm))
        })
    }

    /// A cell is passed at most once between two places.
    fn places(&self, way: &Stroke) -> u32 {
        let most = 4.0 * (self.columns + self.rows) as f64;
        let count = (way.xy_mm / self.cell_mm).ceil();
        if count.is_finite() { count.clamp(1.0, most) as u32 } else { 1 }
    }
}
