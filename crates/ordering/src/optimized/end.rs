//! Ends of items, and what the search has in common.

/// Least saving of an improvement (millimetres or seconds), far above rounding and far below anything that matters,
/// so that the search ends.
pub const GAIN: f64 = 1e-7;

/// No group: that of the sentinels.
pub const NONE: u32 = u32::MAX;

/// One of the two nodes at a gap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct End {
    /// The gap.
    pub gap: u32,
    /// The node after the gap rather than the one before it.
    pub right: bool,
}

impl End {
    /// The other node at the gap.
    #[inline]
    pub fn across(self) -> Self {
        Self { right: !self.right, ..self }
    }
}
