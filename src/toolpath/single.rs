//! Where an island has its outermost wall alone: on surfaces that nothing covers, which top lines fill up to it.

use geometry::Region;

use super::options::{SingleOnTop, WallSettings};

/// How many walls an island gets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Count {
    /// As many as set.
    All,
    /// The outermost alone.
    One,
    /// The outermost alone where the surface is bare, elsewhere all.
    OneWhereBare,
}

impl Count {
    /// Of the islands of an object with this section `above` them, on the layer of that index.
    pub fn of(settings: &WallSettings, above: &Region, layer: usize) -> Self {
        let is_last = above.is_empty();
        match settings.single_on_top {
            _ if settings.count < 2 => Self::All,
            _ if settings.single_on_first_layer && layer == 0 => Self::One,
            SingleOnTop::Top | SingleOnTop::Topmost if is_last => Self::One,
            SingleOnTop::Top => Self::OneWhereBare,
            SingleOnTop::None | SingleOnTop::Topmost => Self::All,
        }
    }
}

/// The part of the area inside an outermost wall that nothing covers and that does not hang over air, where it is at
/// least `least_mm` wide. It reaches under what covers the rest by `under_mm`. `beneath`: `None` is the bed.
pub(super) fn bare(
    inside: &Region,
    above: &Region,
    beneath: Option<&Region>,
    least_mm: f64,
    under_mm: f64,
) -> Region {
    let mut bare = geometry::difference(inside, above);
    if let Some(beneath) = beneath {
        bare = geometry::intersection(&bare, beneath);
    }
    geometry::offset(&geometry::opening(&bare, least_mm / 2.0), under_mm)
}
