//! Sets of parallel lines, with their ends joined along the boundary: what straight patterns consist of.

use crate::geom::{self, Region};

use super::FillLine;
use super::connect::{Chord, connect};

/// Parallel lines through a region, `distance_mm` apart, line ends joined where the way is at most `connect_mm`.
pub fn parallel(
    region: &Region,
    angle_rad: f64,
    distance_mm: f64,
    phase_mm: f64,
    connect_mm: f64,
) -> Vec<FillLine> {
    let chords = geom::scan_lines(region, angle_rad, distance_mm, phase_mm)
        .into_iter()
        .flat_map(|line| {
            line.segments.into_iter().map(move |[a, b]| Chord {
                points: vec![a.point, b.point],
                ends: [Some(a.on), Some(b.on)],
                line: line.index,
            })
        })
        .collect();
    connect(region, chords, connect_mm)
}
