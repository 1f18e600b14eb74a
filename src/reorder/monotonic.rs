//! Top surfaces whose lines a file draws one beside the other, never back: that is seen, and stays so.

use geometry::real;

use super::block::{Block, Path};
use crate::toolpath::Role;

/// Lines further than this from each other, in millimetres, are of different surfaces.
const BESIDE_MM: f64 = 2.0;

/// Lines nearer than this, across their direction, are pieces of one.
const SAME_MM: f64 = 0.05;

/// Lines are parallel if the sine of the angle between them is at most this.
const PARALLEL: f64 = 0.02;

/// This many lines one beside the other are no accident.
const LEAST: usize = 4;

/// This many beads that are no such lines, at the edge of a hole say, do not interrupt a surface.
const STRANGERS: usize = 4;

/// For each path whether it belongs to the one before it, as the next line of a surface.
pub(super) fn kept(block: &Block, island: &[u32]) -> Vec<bool> {
    let lines: Vec<Option<Line>> = block.paths.iter().map(|path| Line::of(block, path)).collect();
    let mut kept = vec![false; lines.len()];
    let mut first = 0;
    while first < lines.len() {
        let end = end(&lines, island, first);
        if end - first >= LEAST {
            kept[first + 1..end].fill(true);
        }
        first = end;
    }
    kept
}

/// Where the lines end of which this is the first, each beside the one before and never back.
fn end(lines: &[Option<Line>], island: &[u32], first: usize) -> usize {
    let (mut last, mut sign) = (first, 0.0);
    while let Some(line) = &lines[last] {
        let strangers = if last - first + 1 < LEAST { 0 } else { STRANGERS };
        let near =
            (last + 1..lines.len().min(last + 2 + strangers)).take_while(|&i| island[i] == island[last]);
        let others = near.map_while(|i| Some((i, line.step_mm(lines[i].as_ref()?))));
        let goes_on = |step_mm: f64| step_mm.abs() <= SAME_MM || step_mm * sign >= 0.0;
        let next = others.filter_map(|(i, step_mm)| Some((i, step_mm.filter(|&mm| goes_on(mm))?))).next();
        let Some((next, step_mm)) = next else { break };
        sign = if step_mm.abs() > SAME_MM { step_mm.signum() } else { sign };
        last = next;
    }
    last + 1
}

/// A bead of a top surface, as its longest stroke.
struct Line {
    from: [f64; 2],
    /// Of unit length, upwards or to the right.
    along: [f64; 2],
}

impl Line {
    fn of(block: &Block, path: &Path) -> Option<Self> {
        if path.role != Some(Role::TopSolidInfill) {
            return None;
        }
        let points: Vec<[f64; 2]> = block.points(path).collect();
        let length = |w: &[[f64; 2]]| real::hypot(w[1][0] - w[0][0], w[1][1] - w[0][1]);
        let longest = points.windows(2).max_by(|a, b| length(a).total_cmp(&length(b)))?;
        let length_mm = length(longest);
        let along = [0, 1].map(|k| (longest[1][k] - longest[0][k]) / length_mm);
        let up = along[1] > PARALLEL || (along[1].abs() <= PARALLEL && along[0] > 0.0);
        (length_mm > 0.0).then(|| Self { from: longest[0], along: along.map(|v| if up { v } else { -v }) })
    }

    /// How far another line lies to the left, if it is beside this one.
    fn step_mm(&self, other: &Self) -> Option<f64> {
        let [x, y] = self.along;
        let turn = x * other.along[1] - y * other.along[0];
        let step_mm = x * (other.from[1] - self.from[1]) - y * (other.from[0] - self.from[0]);
        (turn.abs() <= PARALLEL && step_mm.abs() <= BESIDE_MM).then_some(step_mm)
    }
}
