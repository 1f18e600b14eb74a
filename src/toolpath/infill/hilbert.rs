//! The curve that passes through every cell of a square grid and never crosses itself: few long travels, no crossings.
//!
//! D. Hilbert, "Über die stetige Abbildung einer Linie auf ein Flächenstück", Mathematische Annalen 38 (1891),
//! DOI 10.1007/BF01199431. The curve is one for the whole plane, so that those of all layers lie on each other; only the
//! part near the region is made.

use geometry::Region;

use super::super::bead::Line;
use super::pattern::FillPattern;
use super::spec::FillSpec;
use super::waves::{self, Frame};

/// Halvings from the whole curve to a cell: with cells of 0.4 mm it spans 26 m.
const ORDER: u32 = 16;

/// For each orientation of the curve in a square, its quarters in order: which one (x, y), and the orientation in that.
const ORIENTATIONS: [[([i64; 2], usize); 4]; 4] = [
    [([0, 0], 1), ([0, 1], 0), ([1, 1], 0), ([1, 0], 3)],
    [([0, 0], 0), ([1, 0], 1), ([1, 1], 1), ([0, 1], 2)],
    [([1, 1], 3), ([1, 0], 2), ([0, 0], 2), ([0, 1], 1)],
    [([1, 1], 2), ([0, 1], 3), ([0, 0], 3), ([1, 0], 0)],
];

/// See the module.
#[derive(Debug)]
pub struct Hilbert;

impl FillPattern for Hilbert {
    fn fill(&self, region: &Region, spec: &FillSpec) -> Vec<Line> {
        let frame = Frame::new(spec.angle_rad);
        let Some([low, high]) = frame.extent_mm(region) else {
            return Vec::new();
        };
        let cell_mm = spec.line_distance_mm;
        let [columns, rows] = [0, 1].map(|i| waves::steps(low[i], high[i], cell_mm));
        let mut walk = Walk {
            low: [*columns.start(), *rows.start()],
            high: [*columns.end(), *rows.end()],
            pieces: Vec::new(),
        };
        let half = 1 << (ORDER - 1);
        walk.square([-half; 2], 2 * half, 0);
        let middle =
            |[x, y]: [i64; 2]| frame.point([x as f64 + 0.5, y as f64 + 0.5].map(|cells| cells * cell_mm));
        let pieces = walk.pieces.into_iter().map(|piece| piece.into_iter().map(middle).collect());
        waves::lay(region, pieces, spec)
    }
}

/// The parts of the curve within a range of cells.
struct Walk {
    low: [i64; 2],
    high: [i64; 2],
    pieces: Vec<Vec<[i64; 2]>>,
}

impl Walk {
    fn square(&mut self, corner: [i64; 2], side: i64, orientation: usize) {
        if (0..2).any(|i| corner[i] > self.high[i] || corner[i] + side <= self.low[i]) {
            return;
        }
        if side > 1 {
            let half = side / 2;
            for (quarter, orientation) in ORIENTATIONS[orientation] {
                self.square([0, 1].map(|i| corner[i] + half * quarter[i]), half, orientation);
            }
            return;
        }
        let beside = |cell: &[i64; 2]| (cell[0] - corner[0]).abs() + (cell[1] - corner[1]).abs() == 1;
        match self.pieces.last_mut().filter(|piece| piece.last().is_some_and(beside)) {
            Some(piece) => piece.push(corner),
            None => self.pieces.push(vec![corner]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_enters_each_cell_once_and_steps_from_cell_to_cell() {
        let mut walk = Walk { low: [0; 2], high: [15; 2], pieces: Vec::new() };
        walk.square([0; 2], 16, 0);
        assert_eq!(walk.pieces.len(), 1, "one piece");
        let mut cells = walk.pieces.remove(0);
        cells.sort_unstable();
        cells.dedup();
        assert_eq!(cells.len(), 256);
    }
}
