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
    connect(region, chords(region, angle_rad, distance_mm, phase_mm).collect(), joins)
}

/// Sets of parallel lines, each turned by `turn_rad` against the one before and moved along its normal by its own phase,
/// and each so much wider spaced that together they have the distance of the spec. A line may go on in one of another
/// set, whose ends are nearer than those of its own.
pub fn sets(region: &Region, spec: &FillSpec, turn_rad: f64, phases_mm: &[f64]) -> Vec<Line> {
    let count = phases_mm.len();
    let distance_mm = count as f64 * spec.line_distance_mm;
    let set = |(k, &phase_mm): (usize, &f64)| {
        let angle_rad = spec.angle_rad + k as f64 * turn_rad;
        let own = chords(region, angle_rad, distance_mm, phase_mm);
        own.map(move |chord| Chord { line: count as i64 * chord.line + k as i64, ..chord })
    };
    connect(region, phases_mm.iter().enumerate().flat_map(set).collect(), &spec.joins)
}

fn chords(
    region: &Region,
    angle_rad: f64,
    distance_mm: f64,
    phase_mm: f64,
) -> impl Iterator<Item = Chord> + use<> {
    geom::scan_lines(region, angle_rad, distance_mm, phase_mm).into_iter().flat_map(|line| {
        line.segments.into_iter().map(move |[a, b]| Chord {
            points: vec![a.point, b.point],
            ends: [Some(a.on), Some(b.on)],
            line: line.index,
        })
    })
}
