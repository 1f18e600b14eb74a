//! Top surfaces whose lines a file draws from one side to the other: none between two that are there, nor behind one. That is
//! seen, and stays so.

use geometry::{DisjointSets, real};

use super::block::{Block, Path};
use crate::toolpath::Role;

/// Lines further than this from each other, in millimetres, are of different surfaces.
const BESIDE_MM: f64 = 2.0;

/// Lines nearer than this, across their direction, are pieces of one.
const SAME_MM: f64 = 0.05;

/// Two lines have no room for one between them if they are nearer than this many times the distance of the next.
const AGAINST: f64 = 1.5;

/// Lines are parallel if the sine of the angle between them is at most this.
const PARALLEL: f64 = 0.02;

/// This many lines in order are no accident.
const LEAST: usize = 4;

/// For each path whether it belongs to the one before it, as the next line of such a surface or as one that the file draws
/// between two of its lines.
pub(super) fn kept(block: &Block, island: &[u32]) -> Vec<bool> {
    let mut kept = vec![false; block.paths.len()];
    let lines = block.paths.iter().enumerate().filter_map(|(path, own)| Line::of(block, path, own));
    let lines: Vec<Line> = lines.collect();
    for lines in lines.chunk_by(|a, b| b.path == a.path + 1 && island[a.path] == island[b.path]) {
        for surface in surfaces(lines).into_iter().filter(Surface::is_monotonic) {
            kept[lines[surface.first].path + 1..=lines[surface.last].path].fill(true);
        }
    }
    kept
}

/// Lines of which each lies against another.
struct Surface {
    first: usize,
    last: usize,
    lines: usize,
    /// So many lie to the left and to the right of one against them that is drawn before.
    sides: [usize; 2],
}

impl Surface {
    fn is_monotonic(&self) -> bool {
        self.lines >= LEAST && self.sides.contains(&0)
    }
}

/// The surfaces that lines make, in the order of their first ones.
fn surfaces(lines: &[Line]) -> Vec<Surface> {
    let mut pairs = pairs(lines);
    let mut nearest_mm = vec![BESIDE_MM; lines.len()];
    for &(line, other, step_mm) in &pairs {
        [line, other].into_iter().for_each(|own| nearest_mm[own] = step_mm.abs().min(nearest_mm[own]));
    }
    pairs.retain(|&(line, other, step_mm)| step_mm.abs() < AGAINST * nearest_mm[line].min(nearest_mm[other]));
    let mut sets = DisjointSets::new(lines.len());
    for &(line, other, _) in &pairs {
        sets.join(line as u32, other as u32);
    }
    let (of, count) = sets.number();
    let mut surfaces: Vec<Surface> =
        (0..count).map(|_| Surface { first: lines.len(), last: 0, lines: 0, sides: [0; 2] }).collect();
    for (line, own) in of.iter().enumerate() {
        let surface = &mut surfaces[*own as usize];
        surface.first = surface.first.min(line);
        surface.last = line;
        surface.lines += 1;
    }
    for (line, _, step_mm) in pairs {
        surfaces[of[line] as usize].sides[usize::from(step_mm < 0.0)] += 1;
    }
    surfaces
}

/// Lines that lie side by side, each pair with the earlier one first, and how far the later one lies to the left.
fn pairs(lines: &[Line]) -> Vec<(usize, usize, f64)> {
    let mut pairs = Vec::new();
    let mut left: Vec<usize> = (0..lines.len()).collect();
    while let Some(first) = left.first() {
        let along = lines[*first].along;
        let parallel: Vec<usize> = left.extract_if(.., |line| lines[*line].is_parallel(along)).collect();
        let mut spans: Vec<_> = parallel.into_iter().map(|line| (line, lines[line].span_mm(along))).collect();
        spans.sort_by(|(_, one), (_, other)| one.across.total_cmp(&other.across));
        for (place, (line, own)) in spans.iter().enumerate() {
            for (other, next) in &spans[place + 1..] {
                let step_mm = next.across - own.across;
                if step_mm > BESIDE_MM {
                    break;
                }
                let side_by_side = own.from.max(next.from) < own.to.min(next.to);
                if step_mm > SAME_MM && side_by_side {
                    pairs.push(if line < other {
                        (*line, *other, step_mm)
                    } else {
                        (*other, *line, -step_mm)
                    });
                }
            }
        }
    }
    pairs
}

/// From where to where a line leads along a direction, and where across it lies, mm.
struct Span {
    from: f64,
    to: f64,
    across: f64,
}

/// A bead of a top surface, as its longest stroke.
struct Line {
    path: usize,
    ends: [[f64; 2]; 2],
    /// Of unit length, upwards or to the right.
    along: [f64; 2],
}

impl Line {
    fn of(block: &Block, number: usize, path: &Path) -> Option<Self> {
        if path.role != Some(Role::TopSolidInfill) {
            return None;
        }
        let points: Vec<[f64; 2]> = block.points(path).collect();
        let length = |w: &[[f64; 2]]| real::hypot(w[1][0] - w[0][0], w[1][1] - w[0][1]);
        let longest = points.windows(2).max_by(|a, b| length(a).total_cmp(&length(b)))?;
        let length_mm = length(longest);
        let along = [0, 1].map(|k| (longest[1][k] - longest[0][k]) / length_mm);
        let up = along[1] > PARALLEL || (along[1].abs() <= PARALLEL && along[0] > 0.0);
        (length_mm > 0.0).then(|| Self {
            path: number,
            ends: [longest[0], longest[1]],
            along: along.map(|v| if up { v } else { -v }),
        })
    }

    fn is_parallel(&self, along: [f64; 2]) -> bool {
        (self.along[0] * along[1] - self.along[1] * along[0]).abs() <= PARALLEL
    }

    fn span_mm(&self, [x, y]: [f64; 2]) -> Span {
        let [from, to] = self.ends.map(|end| x * end[0] + y * end[1]);
        let [one, other] = self.ends.map(|end| x * end[1] - y * end[0]);
        Span { from: from.min(to), to: from.max(to), across: one.midpoint(other) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first and the last line of each monotonic surface, of lines from left to right, from x to x at y.
    fn monotonic(lines: &[[f64; 3]]) -> Vec<[usize; 2]> {
        let line = |(path, &[from, to, y]): (usize, &[f64; 3])| Line {
            path,
            ends: [[from, y], [to, y]],
            along: [1.0, 0.0],
        };
        let lines: Vec<Line> = lines.iter().enumerate().map(line).collect();
        let surfaces = surfaces(&lines).into_iter().filter(Surface::is_monotonic);
        surfaces.map(|surface| [surface.first, surface.last]).collect()
    }

    #[test]
    fn both_sides_of_a_hole_are_one_surface_and_so_is_what_lies_between_its_lines() {
        let left = [[0.0, 4.0, 0.8], [0.0, 4.0, 1.2]];
        let right = [[6.0, 9.0, 0.8], [6.0, 9.0, 1.2]];
        let around: Vec<[f64; 3]> =
            [[[0.0, 9.0, 0.0], [0.0, 9.0, 0.4]], left, right, [[0.0, 9.0, 1.6], [0.0, 9.0, 2.0]]].concat();
        assert_eq!(monotonic(&around), [[0, 7]]);
        let mut with_another = around.clone();
        with_another.insert(4, [20.0, 25.0, 0.8]);
        assert_eq!(monotonic(&with_another), [[0, 8]]);
    }

    #[test]
    fn a_surface_with_a_line_between_two_others_is_none() {
        let rows = [0.0, 0.8, 0.4, 1.2, 1.6, 2.0];
        assert_eq!(monotonic(&rows.map(|y| [0.0, 9.0, y])), [[0; 2]; 0]);
        assert_eq!(monotonic(&[2.0, 1.6, 1.2, 0.8].map(|y| [0.0, 9.0, y])), [[0, 3]]);
    }
}
