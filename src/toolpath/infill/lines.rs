//! Sets of parallel lines, with their ends joined along the boundary: what straight patterns consist of.

use geometry::{Direction, Point, Region};

use super::super::bead::Line;
use super::FillSpec;
use super::connect::{Chord, Joins, connect};

/// Parallel lines all over the plane: line `k` is `k · distance + phase` from the origin, along the normal (−sin, cos) of
/// the angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineSet {
    /// Their direction, radians from the X axis.
    pub angle_rad: f64,
    /// Their distance in millimetres.
    pub distance_mm: f64,
    /// See above.
    pub phase_mm: f64,
}

impl LineSet {
    /// The way that they run.
    pub fn direction(&self) -> Direction {
        Direction::of(self.angle_rad)
    }

    /// How many lines a place is away from line 0, along the normal.
    pub fn lines_to(&self, place: Point) -> f64 {
        (self.direction().across_mm(place) - self.phase_mm) / self.distance_mm
    }
}

/// Sets of a layer, each turned by `turn_rad` against the one before and moved along its normal by its own phase, and
/// each so much wider spaced that together they have the distance of the spec.
pub fn sets(spec: &FillSpec, turn_rad: f64, phases_mm: &[f64]) -> Vec<LineSet> {
    let distance_mm = phases_mm.len() as f64 * spec.line_distance_mm;
    let set = |(k, &phase_mm): (usize, &f64)| {
        let angle_rad = spec.angle_rad + k as f64 * turn_rad;
        LineSet { angle_rad, distance_mm, phase_mm }
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
    lay(region, &[LineSet { angle_rad, distance_mm, phase_mm }], joins)
}

/// The lines of sets through a region, their ends treated as `joins` says. A line may go on in one of another set, whose
/// ends are nearer than those of its own.
pub fn lay(region: &Region, sets: &[LineSet], joins: &Joins) -> Vec<Line> {
    let count = sets.len();
    let chords = sets.iter().enumerate().flat_map(|(k, set)| {
        let lines = geometry::scan_lines(region, set.angle_rad, set.distance_mm, set.phase_mm);
        lines.into_iter().flat_map(move |line| {
            line.segments.into_iter().map(move |[a, b]| Chord {
                points: vec![a.point, b.point],
                ends: [Some(a.on), Some(b.on)],
                line: count as i64 * line.index + k as i64,
            })
        })
    });
    connect(region, chords.collect(), joins)
}
