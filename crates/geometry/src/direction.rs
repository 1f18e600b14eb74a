//! A direction in the plane, and how points lie relative to it.

use crate::real;

use super::Point;

/// A direction: points have a coordinate along it, and one across it, to its left, both from the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Direction {
    sin: f64,
    cos: f64,
}

impl Direction {
    /// The direction at an angle, in radians from the X axis.
    pub fn of(angle_rad: f64) -> Self {
        let (sin, cos) = real::sin_cos(angle_rad);
        Self { sin, cos }
    }

    /// The coordinate along it, in millimetres.
    pub fn along_mm(self, point: Point) -> f64 {
        let [x, y] = point.mm();
        x * self.cos + y * self.sin
    }

    /// The coordinate across it, in millimetres.
    pub fn across_mm(self, point: Point) -> f64 {
        let [x, y] = point.mm();
        y * self.cos - x * self.sin
    }

    /// The smallest and the largest coordinate across it of some points, in millimetres.
    pub fn extent_mm<'a>(self, points: impl IntoIterator<Item = &'a Point>) -> (f64, f64) {
        let across_mm = points.into_iter().map(|&point| self.across_mm(point));
        across_mm.fold((f64::MAX, f64::MIN), |(low, high), mm| (low.min(mm), high.max(mm)))
    }

    /// The point so far along and across from another, in millimetres.
    pub fn from(self, point: Point, along_mm: f64, across_mm: f64) -> Point {
        let [x, y] = point.mm();
        Point::from_mm(
            x + along_mm * self.cos - across_mm * self.sin,
            y + along_mm * self.sin + across_mm * self.cos,
        )
    }
}
