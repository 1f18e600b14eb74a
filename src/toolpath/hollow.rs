//! The layer beneath, where it may be filled with sparse infill: only its lines hold something there.

use std::cell::OnceCell;

use geometry::{EdgeGrid, Point, Region};

use super::infill::LineSet;
use super::shell_windows::{ShellWindows, Window};

/// What a layer rests on.
#[derive(Debug)]
pub struct Hollow<'a> {
    beneath: &'a Region,
    windows: ShellWindows<'a>,
    /// How wide its walls are together.
    pub walls_mm: f64,
    /// The lines of the sparse infill; none if it has no straight ones, as its supports are unknown then.
    pub sparse: Vec<LineSet>,
    // Each is made when it is first asked: walls alone hold most ends.
    section: OnceCell<EdgeGrid>,
    top: OnceCell<EdgeGrid>,
    bottom: OnceCell<EdgeGrid>,
}

impl<'a> Hollow<'a> {
    /// Of the section beneath and its windows: where they overlap with it there is sparse infill; elsewhere solid infill, walls
    /// or nothing.
    pub fn new(beneath: &'a Region, windows: ShellWindows<'a>, walls_mm: f64, sparse: Vec<LineSet>) -> Self {
        let [section, top, bottom] = [const { OnceCell::new() }; 3];
        Self { beneath, windows, walls_mm, sparse, section, top, bottom }
    }

    /// Whether there is sparse infill around a point, or walls around sparse infill.
    pub fn contains(&self, p: Point) -> bool {
        self.section().contains(p) && self.is_in_windows(p)
    }

    /// Whether something lies under a point, or at most `reach_mm` beside it: walls, solid infill or a sparse line.
    pub fn holds(&self, p: Point, reach_mm: f64) -> bool {
        let wall_mm = self.walls_mm + reach_mm;
        let is_in_walls = || self.section().distance_mm(p, wall_mm) < wall_mm;
        (self.is_on_a_line(p, reach_mm) || is_in_walls() || !self.is_in_windows(p))
            && self.section().contains(p)
    }

    /// Whether a sparse line is at most so far away.
    fn is_on_a_line(&self, p: Point, reach_mm: f64) -> bool {
        self.sparse.iter().any(|set| {
            let lines = set.lines_to(p);
            (lines - lines.round()).abs() * set.distance_mm <= reach_mm
        })
    }

    fn section(&self) -> &EdgeGrid {
        self.section.get_or_init(|| EdgeGrid::new(self.beneath))
    }

    fn is_in_windows(&self, p: Point) -> bool {
        let area = |window: Option<Window<'a>>| EdgeGrid::new(window.map_or(self.beneath, Window::region));
        let top = self.top.get_or_init(|| area(self.windows.top));
        top.contains(p) && self.bottom.get_or_init(|| area(self.windows.bottom)).contains(p)
    }
}
