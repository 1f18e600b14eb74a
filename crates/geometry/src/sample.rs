//! Numbered vertices of a triangulation.

use spade::{HasPosition, Point2};

/// A vertex that knows its place in the caller's list.
pub(crate) struct Sample {
    pub(crate) at: [f64; 2],
    pub(crate) index: u32,
}

impl HasPosition for Sample {
    type Scalar = f64;
    fn position(&self) -> Point2<f64> {
        Point2::new(self.at[0], self.at[1])
    }
}
