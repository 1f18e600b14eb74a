//! Sets of parallel lines, with their ends joined along the boundary: what straight patterns consist of.

use crate::geom::{self, Region};

use super::super::bead::Line;
use super::FillSpec;
use super::connect::{Chord, Joins, connect};

/// Parallel lines through a region, `distance_mm` apart, line their ends treated as `joins` says.
pub fn parallel(
    region: &Region,
    angle_rad: f64,
    distance_mm: f64,
    phase_mm: f64,
    joins: &Joins,
) -> Vec<Line> {
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
    connect(region, chords, joins)
}

/// So many sets of parallel lines, each turned by `turn_rad` against the one before, and each so much wider spaced
/// that together they have the distance of the spec.
pub fn sets(region: &Region, spec: &FillSpec, count: u32, turn_rad: f64) -> Vec<Line> {
    let distance_mm = f64::from(count) * spec.line_distance_mm;
    let set = |k: u32| {
        let angle_rad = spec.angle_rad + f64::from(k) * turn_rad;
        parallel(region, angle_rad, distance_mm, 0.0, &spec.joins)
    };
    (0..count).flat_map(set).collect()
}
