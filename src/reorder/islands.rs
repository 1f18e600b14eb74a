//! Which beads belong together.

use super::block::Block;
use crate::order::Parts;

/// Beads nearer to each other than about this belong to one island, mm.
const REACH_MM: f64 = 0.6;
/// At most so many cells; of larger blocks the cells are larger.
const MOST_CELLS: f64 = 4e6;
/// Beads are drawn in steps of at most so many cells.
const STEP: f64 = 0.7;

/// The island of every path: connected sets of beads, numbered as they first appear in the file.
///
/// Beads are drawn into a grid, and those that share a cell or have neighbouring ones are joined. O(way / reach).
pub(super) fn islands(block: &Block) -> Vec<u32> {
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for p in block.paths.iter().flat_map(|path| block.points(path)) {
        for i in 0..2 {
            low[i] = low[i].min(p[i]);
            high[i] = high[i].max(p[i]);
        }
    }
    let area = (high[0] - low[0] + 2.0) * (high[1] - low[1] + 2.0);
    let cell_mm = REACH_MM.max((area / MOST_CELLS).sqrt());
    let per_mm = 1.0 / cell_mm;
    let width = ((high[0] - low[0]) / cell_mm) as usize + 3;
    let height = ((high[1] - low[1]) / cell_mm) as usize + 3;
    let mut sets = Parts::new(block.paths.len());
    let mut cells = vec![u32::MAX; width * height];
    for (index, path) in block.paths.iter().enumerate() {
        let mut last: Option<[f64; 2]> = None;
        for p in block.points(path) {
            let p = [0, 1].map(|i| (p[i] - low[i]) * per_mm + 1.0);
            let from = last.replace(p).unwrap_or(p);
            let way = [p[0] - from[0], p[1] - from[1]];
            let steps = ((way[0] * way[0] + way[1] * way[1]).sqrt() / STEP) as usize + 1;
            for step in 1..=steps {
                let share = step as f64 / steps as f64;
                let [x, y] = [0, 1].map(|i| (from[i] + share * way[i]) as usize);
                let cell = &mut cells[y * width + x];
                match *cell {
                    u32::MAX => *cell = index as u32,
                    other => _ = sets.join(other, index as u32),
                }
            }
        }
    }
    let rows: Vec<&[u32]> = cells.chunks_exact(width).collect();
    for pair in rows.windows(2) {
        let (below, row) = (pair[0], pair[1]);
        for x in 1..width - 1 {
            if row[x] != u32::MAX {
                for near in [row[x - 1], below[x - 1], below[x], below[x + 1]] {
                    if near != u32::MAX {
                        sets.join(near, row[x]);
                    }
                }
            }
        }
    }
    (0..block.paths.len() as u32).map(|path| sets.find(path)).collect()
}
