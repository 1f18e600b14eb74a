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
    grids: OnceCell<[EdgeGrid; 3]>,
}

impl<'a> Hollow<'a> {
    /// Of the section beneath and its windows: where they overlap with it there is sparse infill; elsewhere solid infill, walls
    /// or nothing.
    pub fn new(beneath: &'a Region, windows: ShellWindows<'a>, walls_mm: f64, sparse: Vec<LineSet>) -> Self {
        Self { beneath, windows, walls_mm, sparse, grids: OnceCell::new() }
    }

    /// Whether there is sparse infill around a point, or walls around sparse infill.
    pub fn contains(&self, p: Point) -> bool {
        self.grids().iter().all(|grid| grid.contains(p))
    }

    /// Whether something lies under a point, or at most `reach_mm` beside it: walls, solid infill or a sparse line.
    pub fn holds(&self, p: Point, reach_mm: f64) -> bool {
        let [section, top, bottom] = self.grids();
        let wall_mm = self.walls_mm + reach_mm;
        let is_solid =
            || !(top.contains(p) && bottom.contains(p)) || section.distance_mm(p, wall_mm) < wall_mm;
        section.contains(p) && (self.is_on_a_line(p, reach_mm) || is_solid())
    }

    /// Whether a sparse line is at most so far away.
    fn is_on_a_line(&self, p: Point, reach_mm: f64) -> bool {
        self.sparse.iter().any(|set| {
            let lines = set.lines_to(p);
            (lines - lines.round()).abs() * set.distance_mm <= reach_mm
        })
    }

    fn grids(&self) -> &[EdgeGrid; 3] {
        let area = |window: Option<Window<'a>>| window.map_or(self.beneath, Window::region);
        self.grids.get_or_init(|| {
            [self.beneath, area(self.windows.top), area(self.windows.bottom)].map(EdgeGrid::new)
        })
    }
}
