//! Sets of parallel lines, with their ends joined along the boundary: what straight patterns consist of.

use geometry::{HatchSegment, Region};

use super::super::bead::Line;
use super::connect::connect;
use super::spec::{Chord, FillSpec, Joins, LineSet};

/// Sets of a layer, each turned by `rotation_rad` against the one before and moved along its normal by its own phase, and
/// each so much wider spaced that together they have the distance of the spec.
pub fn sets(spec: &FillSpec, rotation_rad: f64, phases_mm: &[f64]) -> Vec<LineSet> {
    let distance_mm = phases_mm.len() as f64 * spec.line_distance_mm;
    let set = |(k, &phase_mm): (usize, &f64)| {
        LineSet::new(spec.angle_rad + k as f64 * rotation_rad, distance_mm, phase_mm)
    };
    phases_mm.iter().enumerate().map(set).collect()
}

/// Parallel lines through a region, `distance_mm` apart, their ends treated as `joins` says.
pub fn parallel(
    region: &Region,
    angle_rad: f64,
    distance_mm: f64,
    phase_mm: f64,
    joins: &Joins,
) -> Vec<Line> {
    lay(region, &[LineSet::new(angle_rad, distance_mm, phase_mm)], joins)
}

/// The lines of sets through a region, their ends treated as `joins` says. A line may continue in one of another set, whose
/// ends are nearer than those of its own.
pub fn lay(region: &Region, sets: &[LineSet], joins: &Joins) -> Vec<Line> {
    let count = sets.len();
    let chords = sets.iter().enumerate().flat_map(|(k, set)| {
        let segments = geometry::scan_lines(region, set.angle_rad, set.distance_mm, set.phase_mm);
        segments.into_iter().map(move |HatchSegment { line, ends: [a, b] }| Chord {
            points: vec![a.point, b.point],
            ends: [Some(a.on), Some(b.on)],
            line: count as i64 * line + k as i64,
        })
    });
    connect(region, chords.collect(), joins)
}
