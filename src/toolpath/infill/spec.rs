//! What fills are made by.

use geometry::{BoundaryPos, Direction, Point};

/// Ends of solid and of other fills reach at most this many times the reach along their line, however flat it meets the
/// boundary.
const FLATTEST: [f64; 2] = [4.0, 2.0];

/// What a pattern needs of a layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FillSpec {
    /// Mean distance between beads, in millimetres: the spacing of a solid fill over the density. Patterns with
    /// several sets of lines space each set wider accordingly.
    pub line_distance_mm: f64,
    /// Distance at which two beads lie beside each other, in millimetres.
    pub spacing_mm: f64,
    /// Direction of the layer's lines, in radians from the X axis.
    pub angle_rad: f64,
    /// Index of the layer, from 0.
    pub layer: usize,
    /// Height of the layer's middle over the bed, in millimetres.
    pub z_mm: f64,
    /// What becomes of line ends.
    pub joins: Joins,
}

impl FillSpec {
    /// Only every n-th line, joined as before.
    pub(super) fn sparser(&self, n: u32) -> Self {
        let n = f64::from(n);
        let joins = Joins { longest_mm: n * self.joins.longest_mm, ..self.joins };
        Self { line_distance_mm: n * self.line_distance_mm, joins, ..*self }
    }

    /// The lines as they are, none joined.
    pub(super) fn apart(&self) -> Self {
        Self { joins: Joins { longest_mm: 0.0, ..self.joins }, ..*self }
    }
}

/// Parallel lines all over the plane: line `k` is `k · distance + phase` from the origin, along the normal (−sin, cos) of
/// the angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineSet {
    /// Their direction, radians from the X axis.
    pub angle_rad: f64,
    direction: Direction,
    /// Their distance in millimetres.
    pub distance_mm: f64,
    /// See above.
    pub phase_mm: f64,
}

impl LineSet {
    /// Lines at an angle.
    pub fn new(angle_rad: f64, distance_mm: f64, phase_mm: f64) -> Self {
        Self { angle_rad, direction: Direction::of(angle_rad), distance_mm, phase_mm }
    }

    /// The direction that they run in.
    pub fn direction(&self) -> Direction {
        self.direction
    }

    /// How many lines a position is away from line 0, along the normal.
    pub fn lines_to(&self, point: Point) -> f64 {
        (self.direction.across_mm(point) - self.phase_mm) / self.distance_mm
    }
}

/// How line ends are treated.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Joins {
    /// Ends are joined along the boundary where that path is at most this long, in millimetres.
    pub longest_mm: f64,
    /// How far free ends reach beyond the boundary, in millimetres across it.
    pub reach_mm: f64,
    /// The same of ends whose join turns back sharply and so leaves a wedge open between line and boundary.
    pub turn_reach_mm: f64,
    /// How far free ends run on along the boundary at most, in millimetres.
    pub anchor_mm: f64,
    /// Of solid fills, the lines' arrangement: what no line covers beside the boundary is filled.
    pub hatch: Option<LineSet>,
}

impl Joins {
    /// How far along a line is so far across a boundary: both are given by unit vectors.
    pub(super) fn along_mm(&self, across_mm: f64, line: [f64; 2], edge: [f64; 2]) -> f64 {
        let sine = (line[0] * edge[1] - line[1] * edge[0]).abs();
        across_mm / sine.max(1.0 / self.flattest())
    }

    /// The distance of a solid fill's lines; 0 of other fills.
    pub(super) fn distance_mm(&self) -> f64 {
        self.hatch.map_or(0.0, |hatch| hatch.distance_mm)
    }

    /// How far free ends reach along their line at most.
    pub(super) fn furthest_mm(&self) -> f64 {
        self.reach_mm * self.flattest()
    }

    fn flattest(&self) -> f64 {
        FLATTEST[usize::from(self.hatch.is_none())]
    }
}

/// A piece of a pattern inside the region.
#[derive(Clone, Debug, PartialEq)]
pub struct Chord {
    /// Vertices, at least two.
    pub points: Vec<Point>,
    /// Where it starts and ends on the boundary.
    pub ends: [Option<BoundaryPos>; 2],
    /// Which line of the pattern it is part of: neighbours differ by one.
    pub line: i64,
}

impl Chord {
    /// Its start, side 0, or its end.
    pub(super) fn end(&self, side: usize) -> Point {
        self.points[if side == 0 { 0 } else { self.points.len() - 1 }]
    }
}

/// One end of a chord, at its position on the boundary.
#[derive(Clone, Copy)]
pub(super) struct Stop {
    pub(super) chord: u32,
    pub(super) side: u8,
    pub(super) on: BoundaryPos,
}
