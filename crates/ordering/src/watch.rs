//! Watching a search that takes long.

use std::fmt;

/// A function that is called every few milliseconds of a search, and may end it by unwinding.
///
/// # Examples
/// ```
/// use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
/// use pathwright_geometry::Point;
/// use pathwright_ordering::{Effort, OrderOptions, Polyline, Watch, order_watched};
///
/// let dot = |i: i32| Polyline {
///     points: vec![Point::from_mm(f64::from(i * 37 % 101), f64::from(i * 53 % 103))],
///     closed: false,
///     group: 0,
/// };
/// let dots: Vec<Polyline> = (0..1000).map(dot).collect();
/// let mut options = OrderOptions::default();
/// options.effort = Effort::High;
/// let stop = || resume_unwind(Box::new("enough"));
/// assert!(catch_unwind(AssertUnwindSafe(|| order_watched(&dots, &options, Watch::new(&stop)))).is_err());
/// ```
#[derive(Clone, Copy, Default)]
pub struct Watch<'a>(Option<&'a (dyn Fn() + Sync)>);

impl<'a> Watch<'a> {
    /// By this function.
    pub fn new(look: &'a (dyn Fn() + Sync)) -> Self {
        Self(Some(look))
    }

    /// Lets it look.
    pub fn look(self) {
        if let Some(look) = self.0 {
            look();
        }
    }
}

impl fmt::Debug for Watch<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Watch").finish_non_exhaustive()
    }
}
