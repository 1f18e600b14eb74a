//! What some layers of a print show of where bodies stand.

use std::io::{self, Read};

use super::levels::Levels;
use super::survey::{Extent, Survey, is_part};
use crate::gcode::{Action, Reader, Stroke, each_line};
use crate::toolpath::Role;
use crate::toolpath::support::{Bitmap, Grid};
use geometry::{Bounds, Point};

/// This many layers are looked at.
const LAYERS: usize = 12;
/// Cells in which walls are marked, and the steps in which they are.
const CELL_MM: f64 = 0.2;
const STEP_MM: f64 = 0.15;
/// No more beads of a layer are noted.
const MOST: usize = 100_000;
/// Beads that are nearer than this follow each other.
const CLOSE_MM: f64 = 0.01;

/// One layer of a print.
pub(super) struct PrintedLayer {
    /// Which of the print's layers it is.
    pub level: usize,
    /// Middles of the beads along the edge of the part.
    pub points: Vec<Point>,
    /// Boxes around its loops.
    pub loops: Vec<Extent>,
    /// Where its middle lines are.
    pub walls: Bitmap,
    /// The current loop, and its last position.
    current: Option<(Extent, [f64; 3])>,
}

impl PrintedLayer {
    fn take(&mut self, bead: &Stroke) {
        if self.points.len() < MOST {
            let [x, y, _] = bead.at(0.5);
            self.points.push(Point::from_mm(x, y));
        }
        let goes_on = |end: &[f64; 3]| (0..2).all(|i| (end[i] - bead.from[i]).abs() < CLOSE_MM);
        if self.current.as_ref().is_none_or(|(_, end)| !goes_on(end)) {
            self.end_loop();
        }
        let (mut extent, _) = self.current.take().unzip();
        Extent::add(&mut extent, bead.from);
        Extent::add(&mut extent, bead.to);
        self.current = extent.zip(Some(bead.to));
        let grid = self.walls.grid();
        let count = (bead.xy_mm / STEP_MM).ceil().clamp(1.0, 1e5) as u32;
        for i in 0..=count {
            let [x, y, _] = bead.at(f64::from(i) / f64::from(count));
            if let Some(cell) = grid.cell_at(Point::from_mm(x, y)) {
                self.walls.set(cell);
            }
        }
    }

    fn end_loop(&mut self) {
        if let Some((extent, _)) = self.current.take().filter(|_| self.loops.len() < MOST) {
            self.loops.push(extent);
        }
    }

    /// Whether a wall passes within a cell or so.
    pub fn has_wall(&self, p: Point) -> bool {
        let Some([x, y]) = self.walls.grid().cell_at(p) else { return false };
        let [columns, rows] = self.walls.grid().size();
        let near = |at: usize, count: usize| at.saturating_sub(1)..=(at + 1).min(count - 1);
        near(y, rows).any(|y| near(x, columns).any(|x| self.walls.has([x, y])))
    }
}

/// Reads the file for what layers show, from the lowest to the highest.
pub(super) fn read(levels: &Levels, survey: &Survey, file: impl Read) -> io::Result<Vec<PrintedLayer>> {
    let Some(all) = survey.extents()[1] else { return Ok(Vec::new()) };
    let corners = [all.low, all.high].map(|[x, y]| Point::from_mm(x, y));
    let Some(grid) = Bounds::of(corners).map(|bounds| Grid::new(bounds, 1.0, CELL_MM)) else {
        return Ok(Vec::new());
    };
    let count = levels.all().len();
    let chosen = (0..LAYERS.min(count)).map(|i| i * count / LAYERS.min(count));
    let mut layers: Vec<PrintedLayer> = chosen
        .map(|level| PrintedLayer {
            level,
            points: Vec::new(),
            loops: Vec::new(),
            walls: Bitmap::empty(grid),
            current: None,
        })
        .collect();
    let mut reader = Reader::default();
    each_line(file, |line| {
        let read = reader.read(line);
        let Action::Stroke(bead) = read.action else { return };
        let role = read.context.role;
        let is_edge = if survey.has_edges() { Role::is_outer_wall } else { is_part };
        if !bead.extrudes() || survey.has_roles() && !role.is_some_and(is_edge) {
            return;
        }
        let level = levels.find(levels.rises_to_mm(bead.to[2]));
        if let Some(layer) = layers.iter_mut().find(|layer| Some(layer.level) == level) {
            layer.take(&bead);
        }
    })?;
    layers.iter_mut().for_each(PrintedLayer::end_loop);
    Ok(layers)
}
