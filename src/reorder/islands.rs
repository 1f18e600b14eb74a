//! Which beads belong together.

use super::block::{Block, Path};
use crate::toolpath::Role;
use geometry::DisjointSets;

/// Beads nearer to each other than about this belong to one island, mm.
const REACH_MM: f64 = 0.6;
/// At most this many cells; of larger blocks the cells are larger.
const MOST_CELLS: f64 = 4e6;
/// Beads are drawn in steps of at most this many cells.
const STEP: f64 = 0.7;
/// A wall runs along another bead that is in its cells, or those around them, on this share of the length of either: a wall
/// inside it may be much shorter.
const BESIDE: f64 = 0.75;

/// The relative positions of the paths of a block.
pub(super) struct Islands {
    /// The island of every path: connected sets of beads, numbered as they first appear in the file.
    pub of: Vec<u32>,
    /// For every wall, the last one of its role before it in the file along which it runs.
    pub beside: Vec<Option<u32>>,
}

/// Draws all beads into a grid. Those that share a cell or have neighbouring ones are joined. O(length / reach).
pub(super) fn islands(block: &Block) -> Islands {
    let Some([low, high]) = extent(block) else {
        return Islands { of: Vec::new(), beside: Vec::new() };
    };
    let area = (high[0] - low[0] + 2.0) * (high[1] - low[1] + 2.0);
    let cell_mm = REACH_MM.max((area / MOST_CELLS).sqrt());
    let per_mm = 1.0 / cell_mm;
    // A cell to spare on every side, and one for rounding.
    let width = ((high[0] - low[0]) * per_mm) as usize + 4;
    let height = ((high[1] - low[1]) * per_mm) as usize + 4;
    let mut sets = DisjointSets::new(block.paths.len());
    let mut cells = vec![u32::MAX; width * height];
    // Cells with something in them.
    let mut filled = Vec::new();
    let mut beside = Vec::with_capacity(block.paths.len());
    let mut meetings = Meetings::new(block.paths.len());
    for (index, path) in block.paths.iter().enumerate() {
        let (index, wall) = (index as u32, is_wall(path));
        let mut last: Option<[f64; 2]> = None;
        let mut here = usize::MAX;
        for p in block.points(path) {
            let p = [0, 1].map(|i| (p[i] - low[i]) * per_mm + 1.0);
            let from = last.replace(p).unwrap_or(p);
            let delta = [p[0] - from[0], p[1] - from[1]];
            let length2 = delta[0] * delta[0] + delta[1] * delta[1];
            // Most strokes are short, and dividing and roots take long.
            let steps = if length2 < 0.9 * STEP * STEP { 1 } else { (length2.sqrt() / STEP) as usize + 1 };
            for step in 1..=steps {
                let share = if step == steps { 1.0 } else { step as f64 / steps as f64 };
                let [x, y] = [0, 1].map(|i| (from[i] + share * delta[i]) as usize);
                let at = y * width + x;
                if std::mem::replace(&mut here, at) == at {
                    meetings.stay();
                    continue;
                }
                if wall {
                    let around = [at - width, at, at + width].map(|row| &cells[row - 1..row + 2]);
                    meetings.step(around.into_iter().flatten().copied().filter(|&other| other < index));
                }
                match cells[at] {
                    u32::MAX => {
                        cells[at] = index;
                        filled.push(at);
                    }
                    other => _ = sets.join(other, index),
                }
            }
        }
        beside.push(meetings.finish(|other| block.paths[other as usize].role == path.role));
    }
    for at in filled {
        for near in [at - 1, at - width - 1, at - width, at - width + 1].map(|near| cells[near]) {
            if near != u32::MAX {
                sets.join(near, cells[at]);
            }
        }
    }
    Islands { of: (0..block.paths.len() as u32).map(|path| sets.find(path)).collect(), beside }
}

/// The corners of a rectangle that holds all beads, mm; of no beads, none.
fn extent(block: &Block) -> Option<[[f64; 2]; 2]> {
    let mut corners: Option<[[i64; 2]; 2]> = None;
    for p in block.paths.iter().map(|path| path.from).chain(block.segs.iter().map(|seg| seg.to)) {
        let [low, high] = corners.unwrap_or([p, p]);
        corners = Some([[0, 1].map(|i| low[i].min(p[i])), [0, 1].map(|i| high[i].max(p[i]))]);
    }
    Some(corners?.map(|p| block.mm(p)))
}

/// Counts the steps of a path on which others were met.
struct Meetings {
    /// By path: steps on which it was met, and its own.
    steps: Vec<u32>,
    lengths: Vec<u32>,
    met: Vec<u32>,
    /// Those met on the last step.
    here: Vec<u32>,
    step: u32,
}

impl Meetings {
    fn new(paths: usize) -> Self {
        Self {
            steps: vec![0; paths],
            lengths: Vec::with_capacity(paths),
            met: Vec::new(),
            here: Vec::new(),
            step: 0,
        }
    }

    fn step(&mut self, others: impl Iterator<Item = u32>) {
        self.here.clear();
        for other in others {
            if !self.here.contains(&other) {
                self.here.push(other);
            }
        }
        self.stay();
    }

    /// A step that leads nowhere else.
    fn stay(&mut self) {
        self.step += 1;
        for &other in &self.here {
            let steps = &mut self.steps[other as usize];
            if *steps == 0 {
                self.met.push(other);
            }
            *steps += 1;
        }
    }

    /// The last one of a kind along which the path leads; the next path begins.
    fn finish(&mut self, of_kind: impl Fn(u32) -> bool) -> Option<u32> {
        let runs_along = |&other: &u32| {
            let shorter = self.step.min(self.lengths[other as usize]);
            shorter > 0 && f64::from(self.steps[other as usize]) >= BESIDE * f64::from(shorter)
        };
        let along = self.met.iter().copied().filter(|&other| of_kind(other)).filter(runs_along).max();
        self.met.drain(..).for_each(|other| self.steps[other as usize] = 0);
        self.here.clear();
        self.lengths.push(self.step);
        self.step = 0;
        along
    }
}

pub(super) fn is_wall(path: &Path) -> bool {
    path.role.is_some_and(Role::is_wall)
}

#[cfg(test)]
mod tests {
    use super::super::Blocks;
    use super::*;

    #[test]
    fn a_bead_that_ends_on_the_edge_of_the_last_cell_stays_within_the_grid() {
        // 28 cells high, but for the last bit; the end of the bead is computed to lie in the 29th.
        let text = "M83\n;TYPE:WALL-OUTER\nG1 X9 Y70 F900\nG1 X9 Y72.61 E1\nG1 X9 Y86.8 E1\n";
        let block = Blocks::new(text.as_bytes()).read().expect("read").expect("a block");
        assert_eq!(islands(&block).of, [0]);
    }
}
