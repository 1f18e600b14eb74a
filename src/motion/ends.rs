//! How loops begin and end without a blob: with a gap, or with a scarf.

use super::bead::{Vertex, length_mm};
use geometry::real;
use geometry::{cross, distance_mm};

/// Loops shorter than so many gaps or scarfs stay as they are.
const SHORTEST: f64 = 4.0;

/// A scarf rises and fades in so many steps.
const STEPS: u32 = 10;

/// Share of its height that a scarf begins with.
const BEGIN: f64 = 0.1;

/// A seam is in a corner where the bead turns by more than this (30°) between two places this far from it.
const CORNER_RAD: f64 = std::f64::consts::FRAC_PI_6;
const CORNER_REACH_MM: f64 = 0.3;

/// Ends a closed bead `gap_mm` before it closes.
pub(super) fn clip(vertices: &mut Vec<Vertex>, gap_mm: f64) {
    if gap_mm <= 0.0 || length_mm(vertices) < SHORTEST * gap_mm {
        return;
    }
    let mut left_mm = gap_mm;
    while let [.., before, last] = vertices.as_mut_slice() {
        let edge_mm = distance_mm(before.at, last.at);
        if edge_mm > left_mm {
            *last = before.towards(*last, 1.0 - left_mm / edge_mm);
            return;
        }
        left_mm -= edge_mm;
        vertices.pop();
    }
}

/// Whether a closed bead turns by more than 30° between a little before its seam and a little after it.
pub(super) fn is_corner(vertices: &[Vertex]) -> bool {
    let Some(seam) = vertices.first() else { return false };
    let (after, before) = (beyond(seam.at, vertices.iter()), beyond(seam.at, vertices.iter().rev()));
    let (dot, cross) = (before[0] * after[0] + before[1] * after[1], cross(before, after));
    // Straight on is opposite directions.
    real::atan2(cross.abs(), -dot) > CORNER_RAD
}

/// From the seam to the first of these vertices that is a little away.
fn beyond<'a>(seam: [f64; 2], mut vertices: impl Iterator<Item = &'a Vertex>) -> [f64; 2] {
    let far = vertices.find(|v| distance_mm(v.at, seam) >= CORNER_REACH_MM);
    far.map_or([0.0; 2], |v| [v.at[0] - seam[0], v.at[1] - seam[1]])
}

/// One step of a scarf.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Step {
    /// Where it ends.
    pub to: [f64; 2],
    /// How far below the layer's height it ends, as a share of the bead's height.
    pub below: f64,
    /// What is put down on it.
    pub volume_mm3: f64,
    /// Its cross-section, for the flow limit.
    pub area_mm2: f64,
}

/// A closed bead with a scarf at its seam.
pub(super) struct Scarf {
    /// The rise, from [`BEGIN`] of the height at the start of the bead.
    pub rise: Vec<Step>,
    /// The rest of the loop, from where the rise ends to the seam.
    pub body: Vec<Vertex>,
    /// The end, over the rise: at full height, fading to nothing.
    pub fade: Vec<Step>,
}

impl Scarf {
    /// How far below the layer's height it begins, as a share of the bead's height.
    pub(super) const FIRST_BELOW: f64 = 1.0 - BEGIN;

    /// Makes a scarf of this length of a closed bead; `None`: the bead is too short. Rise and fade together hold what
    /// the loop would have held there.
    pub(super) fn new(vertices: &[Vertex], scarf_mm: f64) -> Option<Self> {
        if scarf_mm <= 0.0 || length_mm(vertices) < SHORTEST * scarf_mm {
            return None;
        }
        let (mut rise, mut fade) = (Vec::new(), Vec::new());
        let mut edges = vertices.windows(2);
        let mut rest = edges.next()?.to_vec();
        for step in 1..=STEPS {
            let mut left_mm = scarf_mm / f64::from(STEPS);
            let share = |at: f64| BEGIN + (1.0 - BEGIN) * at / f64::from(STEPS);
            let (middle, end) = (share(f64::from(step) - 0.5), share(f64::from(step)));
            while left_mm > 1e-9 {
                let [from, to] = [rest[0], rest[1]];
                let edge_mm = distance_mm(from.at, to.at);
                let part = from.towards(to, left_mm / edge_mm.max(f64::MIN_POSITIVE));
                let part_mm = edge_mm.min(left_mm);
                let area_mm2 = 0.5 * (from.area_mm2 + part.area_mm2);
                let piece = |flow: f64, below: f64| Step {
                    to: part.at,
                    below,
                    volume_mm3: flow * area_mm2 * part_mm,
                    area_mm2: flow * area_mm2,
                };
                let reached = end - (1.0 - BEGIN) * (left_mm - part_mm) / scarf_mm;
                rise.push(piece(middle, 1.0 - reached));
                fade.push(piece(1.0 - middle, 0.0));
                left_mm -= part_mm;
                rest = if edge_mm > part_mm { vec![part, to] } else { edges.next()?.to_vec() };
            }
        }
        let body = rest.into_iter().chain(edges.map(|edge| edge[1])).collect();
        Some(Self { rise, body, fade })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Vec<Vertex> {
        let corners = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0], [0.0, 0.0]];
        corners.map(|at| Vertex { at, area_mm2: 0.08 }).to_vec()
    }

    #[test]
    fn a_clipped_loop_is_shorter_by_the_gap() {
        let mut vertices = square();
        clip(&mut vertices, 0.3);
        assert!(distance_mm(vertices[4].at, [0.0, 0.3]) < 1e-9, "{vertices:?}");
        clip(&mut vertices, 9.75);
        assert!((length_mm(&vertices) - 29.95).abs() < 1e-9, "over a corner: {vertices:?}");
        let before = vertices.clone();
        clip(&mut vertices, 10.0);
        assert_eq!(vertices, before, "too short a loop for such a gap");
    }

    #[test]
    fn a_seam_on_an_edge_or_a_curve_is_in_no_corner() {
        assert!(is_corner(&square()));
        let middle = Vertex { at: [5.0, 0.0], area_mm2: 0.08 };
        let edge = [vec![middle], square()[1..4].to_vec(), vec![square()[0], middle]].concat();
        assert!(!is_corner(&edge));
        let on_circle = |k: u32| {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / 60.0).sin_cos();
            Vertex { at: [3.0 * cos, 3.0 * sin], area_mm2: 0.08 }
        };
        assert!(!is_corner(&(0..=60).map(on_circle).collect::<Vec<_>>()));
    }

    #[test]
    fn a_scarf_puts_down_what_the_loop_would_have() {
        let scarf = Scarf::new(&square(), 9.99).expect("long enough");
        let steps = scarf.rise.iter().chain(&scarf.fade);
        let volume = steps.map(|s| s.volume_mm3).sum::<f64>() + 0.08 * length_mm(&scarf.body);
        assert!((volume - 40.0 * 0.08).abs() < 1e-9, "{volume}");
        assert!(scarf.rise.windows(2).all(|w| w[1].below < w[0].below), "it rises");
        assert!(scarf.rise.last().is_some_and(|s| s.below.abs() < 1e-9), "to full height");
        assert_eq!(scarf.rise.last().map(|s| s.to), scarf.fade.last().map(|s| s.to));
        assert!(Scarf::new(&square(), 15.0).is_none());
    }
}
