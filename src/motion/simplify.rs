//! Simplifies beads: drops vertices that hardly deviate from a straight line, and cuts beads of changing width into
//! pieces of constant flow.

use super::bead::Vertex;
use geometry::{Cone, distance_mm};

/// How far a dropped vertex may lie from the line that replaces it: less than half a step of a common machine
/// (80 steps/mm are 12.5 µm each).
pub(super) const MERGE_TOLERANCE_MM: f64 = 0.005;

/// Vertices are dropped only while the cross-section stays within this share of what it was.
const AREA_TOLERANCE: f64 = 0.05;

/// Between pieces of constant flow the cross-section changes by at most this share (what melts follows no faster) …
const AREA_STEP: f64 = 0.2;

/// … unless the pieces would become shorter than this.
const MIN_PIECE_MM: f64 = 0.2;

/// A straight piece of a bead, extruded at constant flow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Piece {
    /// Where it ends.
    pub to: [f64; 2],
    /// What is put down on it.
    pub volume_mm3: f64,
    /// Its cross-section, for the flow limit.
    pub area_mm2: f64,
}

/// Appends the pieces that draw the vertices. Vertices are dropped where the line that replaces them stays
/// within [`MERGE_TOLERANCE_MM`] of them; first and last stay. The volume is that of the undropped path.
///
/// O(n) by intersection of cones.
pub(super) fn straighten(vertices: &[Vertex], out: &mut Vec<Piece>) {
    let Some(&first) = vertices.first() else {
        return;
    };
    let mut anchor = first;
    let mut last = first;
    // With the distance of the farthest vertex.
    let mut cone: Option<(Cone, f64)> = None;
    let mut volume_mm3 = 0.0;
    for &vertex in &vertices[1..] {
        let mut d = [vertex.at[0] - anchor.at[0], vertex.at[1] - anchor.at[1]];
        let mut length_mm = (d[0] * d[0] + d[1] * d[1]).sqrt();
        // The vertex before may be one that only began the piece.
        let alike = [vertex, last]
            .iter()
            .all(|v| (v.area_mm2 - anchor.area_mm2).abs() <= AREA_TOLERANCE * anchor.area_mm2);
        let fits = alike && cone.is_none_or(|(cone, reach_mm)| length_mm >= reach_mm && cone.contains(d));
        // A first vertex after the anchor always starts a piece, whatever its width.
        if !fits && last.at != anchor.at {
            split(anchor, last, volume_mm3, out);
            (anchor, cone, volume_mm3) = (last, None, 0.0);
            d = [vertex.at[0] - anchor.at[0], vertex.at[1] - anchor.at[1]];
            length_mm = (d[0] * d[0] + d[1] * d[1]).sqrt();
        }
        volume_mm3 += 0.5 * (last.area_mm2 + vertex.area_mm2) * distance_mm(last.at, vertex.at);
        if let Some(around) = Cone::around(d, MERGE_TOLERANCE_MM) {
            cone = Some((cone.map_or(around, |(cone, _)| cone.narrowed(around)), length_mm));
        }
        last = vertex;
    }
    split(anchor, last, volume_mm3, out);
}

/// Appends the line from `a` to `b` as pieces of constant flow that hold `volume_mm3` together.
fn split(a: Vertex, b: Vertex, volume_mm3: f64, out: &mut Vec<Piece>) {
    let length_mm = distance_mm(a.at, b.at);
    let change = (b.area_mm2 - a.area_mm2).abs() / a.area_mm2.max(b.area_mm2).max(f64::MIN_POSITIVE);
    let mean_mm2 = (0.5 * (a.area_mm2 + b.area_mm2)).max(f64::MIN_POSITIVE);
    let by_length = (length_mm / MIN_PIECE_MM).floor();
    let count = if change <= AREA_STEP { 1.0 } else { (change / AREA_STEP).ceil().min(by_length).max(1.0) };
    for piece in 1..=count as u32 {
        let (end, middle) = (f64::from(piece) / count, (f64::from(piece) - 0.5) / count);
        let share = (a.area_mm2 + (b.area_mm2 - a.area_mm2) * middle) / mean_mm2;
        let to = if f64::from(piece) == count {
            b.at
        } else {
            [0, 1].map(|i| a.at[i] + (b.at[i] - a.at[i]) * end)
        };
        let area_mm2 = volume_mm3 * share / length_mm.max(f64::MIN_POSITIVE);
        out.push(Piece { to, volume_mm3: volume_mm3 * share / count, area_mm2 });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::to_segment_mm;
    use proptest::prelude::*;

    fn vertices(points: &[[f64; 2]]) -> Vec<Vertex> {
        points.iter().map(|&at| Vertex { at, area_mm2: 0.08 }).collect()
    }

    #[test]
    fn what_a_piece_holds_is_its_cross_section_over_its_length() {
        let areas = [0.08, 0.09, 0.08, 0.0801, 0.12, 0.0805, 0.08];
        let at = |i: usize| [0.3 * i as f64, 0.0];
        let vertices: Vec<Vertex> =
            areas.iter().enumerate().map(|(i, &area_mm2)| Vertex { at: at(i), area_mm2 }).collect();
        let mut out = Vec::new();
        straighten(&vertices, &mut out);
        let mut from = at(0);
        for piece in out {
            let flat_mm3 = piece.area_mm2 * distance_mm(from, piece.to);
            assert!((piece.volume_mm3 / flat_mm3 - 1.0).abs() < 1e-9, "{piece:?}");
            from = piece.to;
        }
    }

    #[test]
    fn collinear_vertices_become_one_piece() {
        let mut out = Vec::new();
        straighten(&vertices(&[[0.0, 0.0], [1.0, 0.001], [2.0, -0.001], [5.0, 0.0]]), &mut out);
        assert_eq!(out.len(), 1);
        assert!((out[0].volume_mm3 - 5.0 * 0.08).abs() < 1e-6);
    }

    #[test]
    fn a_line_that_turns_back_is_kept() {
        let mut out = Vec::new();
        straighten(&vertices(&[[0.0, 0.0], [5.0, 0.0], [3.0, 0.0]]), &mut out);
        assert_eq!(out.iter().map(|p| p.to).collect::<Vec<_>>(), [[5.0, 0.0], [3.0, 0.0]]);
    }

    #[test]
    fn changing_width_is_cut_into_steps_of_the_same_total() {
        let ends = [Vertex { at: [0.0, 0.0], area_mm2: 0.04 }, Vertex { at: [3.0, 0.0], area_mm2: 0.08 }];
        let mut out = Vec::new();
        straighten(&ends, &mut out);
        assert_eq!(out.len(), 3);
        assert!((out.iter().map(|p| p.volume_mm3).sum::<f64>() - 0.18).abs() < 1e-12);
        assert_eq!(out.last().map(|p| p.to), Some([3.0, 0.0]));
    }

    proptest! {
        #[test]
        fn dropped_vertices_lie_within_the_tolerance_and_no_volume_is_lost(
            steps in prop::collection::vec((-0.02..0.05f64, -0.02..0.02f64), 2..60)
        ) {
            let mut at = [0.0, 0.0];
            let points: Vec<[f64; 2]> =
                steps.iter().map(|s| { at = [at[0] + s.0, at[1] + s.1]; at }).collect();
            let mut out = Vec::new();
            straighten(&vertices(&points), &mut out);
            let length: f64 = points.windows(2).map(|w| distance_mm(w[0], w[1])).sum();
            prop_assert!((out.iter().map(|p| p.volume_mm3).sum::<f64>() - 0.08 * length).abs() < 1e-9);
            let kept: Vec<[f64; 2]> = std::iter::once(points[0]).chain(out.iter().map(|p| p.to)).collect();
            for p in &points {
                let near = kept.windows(2).map(|w| to_segment_mm(*p, w[0], w[1])).fold(f64::INFINITY, f64::min);
                prop_assert!(near <= MERGE_TOLERANCE_MM + 1e-9, "{near}");
            }
        }
    }
}
