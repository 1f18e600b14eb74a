//! How loops begin and end without a blob: with a gap, or with a scarf.

use super::bead::{Vertex, length_mm};
use geometry::distance_mm;

/// Loops shorter than so many gaps or scarfs stay as they are.
const SHORTEST: f64 = 4.0;

/// A scarf rises and fades in so many steps.
const STEPS: u32 = 10;

/// Share of its height that a scarf begins with.
const BEGIN: f64 = 0.1;

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
