//! Points of the integer grid.

use std::ops::{Add, Neg, Sub};

/// Grid units per millimetre: one unit is 10 nm.
pub const UNITS_PER_MM: f64 = 100_000.0;

/// Millimetres to the nearest grid unit. Saturates at the limits of `i32` (±21.47 m).
#[inline]
pub fn to_units(mm: f64) -> i32 {
    nearest_unit(mm * UNITS_PER_MM)
}

/// The nearest grid unit, halves away from zero, saturating. (`f64::round` is a call into the C library on baseline
/// x86-64.)
#[inline]
pub(super) fn nearest_unit(units: f64) -> i32 {
    (units + 0.5_f64.copysign(units)) as i32
}

/// Grid units to millimetres.
#[inline]
pub fn to_mm(units: i32) -> f64 {
    f64::from(units) / UNITS_PER_MM
}

/// A point (or a displacement) in the plane, in grid units of 10 nm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Point {
    /// Abscissa in grid units.
    pub x: i32,
    /// Ordinate in grid units.
    pub y: i32,
}

impl Point {
    /// A point from grid units.
    #[inline]
    pub const fn new(x: i32, y: i32) -> Self {
        Self { x, y }
    }

    /// The grid point nearest to a position in millimetres.
    #[inline]
    pub fn from_mm(x_mm: f64, y_mm: f64) -> Self {
        Self::new(to_units(x_mm), to_units(y_mm))
    }

    /// The position in millimetres.
    #[inline]
    pub fn mm(self) -> [f64; 2] {
        [to_mm(self.x), to_mm(self.y)]
    }

    /// z component of the cross product of two displacements, in square units.
    #[inline]
    pub fn cross(self, other: Self) -> i64 {
        i64::from(self.x) * i64::from(other.y) - i64::from(self.y) * i64::from(other.x)
    }

    /// The point at a share of the way to another.
    #[inline]
    pub fn towards(self, to: Self, share: f64) -> Self {
        let along = |from: i32, to: i32| f64::from(from) + (f64::from(to) - f64::from(from)) * share;
        Self::new(along(self.x, to.x).round() as i32, along(self.y, to.y).round() as i32)
    }

    /// Dot product of two displacements, in square units.
    #[inline]
    pub fn dot(self, other: Self) -> i64 {
        i64::from(self.x) * i64::from(other.x) + i64::from(self.y) * i64::from(other.y)
    }

    /// Squared Euclidean distance, in square units.
    #[inline]
    pub fn distance2(self, other: Self) -> i64 {
        let (dx, dy) = (i64::from(self.x) - i64::from(other.x), i64::from(self.y) - i64::from(other.y));
        dx * dx + dy * dy
    }

    /// Euclidean distance in millimetres.
    #[inline]
    pub fn distance_mm(self, other: Self) -> f64 {
        (self.distance2(other) as f64).sqrt() / UNITS_PER_MM
    }
}

impl Add for Point {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y)
    }
}

impl Sub for Point {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y)
    }
}

impl Neg for Point {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y)
    }
}

/// Cross product of two vectors.
#[inline]
pub fn cross(u: [f64; 2], v: [f64; 2]) -> f64 {
    u[0] * v[1] - u[1] * v[0]
}

/// Distance of two points, all in millimetres.
#[inline]
pub fn distance_mm(a: [f64; 2], b: [f64; 2]) -> f64 {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    (dx * dx + dy * dy).sqrt()
}

/// The point of the segment between two points that is nearest to another, all in millimetres.
pub fn on_segment_mm(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    let d = [b[0] - a[0], b[1] - a[1]];
    let along = (p[0] - a[0]) * d[0] + (p[1] - a[1]) * d[1];
    let t = (along / (d[0] * d[0] + d[1] * d[1]).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    [a[0] + t * d[0], a[1] + t * d[1]]
}

/// Distance of a point from the segment between two others, all in millimetres.
pub fn to_segment_mm(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    distance_mm(on_segment_mm(p, a, b), p)
}
