//! A piece of a medial axis.

use crate::Point;

/// A line along the middle of a narrow region, with the region's width at each vertex.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MedialPath {
    /// Vertices, at least two (closed: at least three), no two neighbours equal.
    pub points: Vec<Point>,
    /// Width of the region at each vertex, in millimetres; linear in between.
    pub width_mm: Vec<f32>,
    /// Whether it returns from the last vertex to the first (which is not repeated).
    pub closed: bool,
}

impl MedialPath {
    /// Length in millimetres, the closing edge included.
    pub fn length_mm(&self) -> f64 {
        self.edges().map(|(a, b)| self.points[a].distance_mm(self.points[b])).sum()
    }

    /// Area that a bead of this width covers, without the round ends, in square millimetres.
    pub fn area_mm2(&self) -> f64 {
        let mean = |a: usize, b: usize| f64::from(self.width_mm[a] + self.width_mm[b]) / 2.0;
        self.edges().map(|(a, b)| self.points[a].distance_mm(self.points[b]) * mean(a, b)).sum()
    }

    fn edges(&self) -> impl Iterator<Item = (usize, usize)> {
        let n = self.points.len();
        let count = if self.closed { n } else { n.saturating_sub(1) };
        (0..count).map(move |i| (i, (i + 1) % n))
    }
}
