//! A layer of the prime tower: what each change lays into it.

use crate::motion::SwapSettings;
use crate::profile::Settings;
use crate::toolpath::{Path, Phase, Role, ToolId, Width, bead};
use geometry::Point;

/// One layer of the tower.
#[derive(Clone, Debug)]
pub(super) struct Floor {
    pub height_mm: f64,
    /// Of the lines of each tool.
    pub widths_mm: Vec<f64>,
    /// Depth, which is less towards the top.
    pub depth_mm: f64,
    /// The tool that prints frame and lines: the one that is flushed most, or the one that is in use.
    pub rest: ToolId,
    /// What tools are flushed into.
    pub lines: Lines,
    pub changes: Vec<Flush>,
}

/// What a change lays into the tower.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flush {
    pub from: ToolId,
    pub to: ToolId,
    pub ram: Ram,
    /// What the new tool is flushed with, mm³; less what goes into frame and lines, once their depth is known.
    pub mm3: f64,
}

/// Lines that fill an area of the tower.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Lines {
    /// Their width, of the tower's lines.
    pub width: f64,
    /// Their distance, of their width.
    pub spacing: f64,
}

/// What ramming lays before a tool is left.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Ram {
    pub mm3: f64,
    lines: Lines,
}

/// Lines from one side of the frame to the other, each joined to the next.
pub(super) struct Rows {
    pub width_mm: f64,
    /// Distance at which they would touch each other.
    pub line_mm: f64,
    pub spacing_mm: f64,
    pub length_mm: f64,
    pub count: usize,
}

impl From<&SwapSettings> for Ram {
    fn from(swap: &SwapSettings) -> Self {
        let lines = Lines { width: swap.ramming_width.0, spacing: swap.ramming_spacing.0 };
        Self { mm3: swap.rammed_mm3(), lines }
    }
}

impl Lines {
    /// Those that tools are flushed into.
    pub fn of_flushes(on_bed: bool, settings: &Settings) -> Self {
        let tower = &settings.prime_tower;
        Self { width: tower.flush_width.0, spacing: if on_bed { 1.0 } else { tower.flush_spacing.0 } }
    }
}

impl Rows {
    pub fn depth_mm(&self) -> f64 {
        self.count as f64 * self.spacing_mm
    }
}

impl Floor {
    fn width_mm(&self, tool: ToolId) -> f64 {
        self.widths_mm[usize::from(tool)]
    }

    fn area_mm2(&self, tool: ToolId) -> f64 {
        bead::area_mm2(self.width_mm(tool), self.height_mm)
    }

    pub fn spacing_mm(&self, tool: ToolId) -> f64 {
        bead::spacing_mm(self.width_mm(tool), self.height_mm)
    }

    /// The rows that a volume of a tool takes, where there is so much room inside of the frame.
    fn rows(&self, tool: ToolId, volume_mm3: f64, lines: Lines, inside_mm: f64) -> Rows {
        let width_mm = self.width_mm(tool) * lines.width;
        let line_mm = bead::spacing_mm(width_mm, self.height_mm);
        let length_mm = volume_mm3 / bead::area_mm2(width_mm, self.height_mm).max(f64::MIN_POSITIVE);
        let count = if volume_mm3 > 0.0 { ((length_mm + line_mm) / inside_mm).ceil() as usize } else { 0 };
        Rows { width_mm, line_mm, spacing_mm: line_mm * lines.spacing, length_mm, count }
    }

    /// What is rammed at a change.
    pub fn rammed(&self, change: &Flush, inside_mm: f64) -> Rows {
        self.rows(change.from, change.ram.mm3, change.ram.lines, inside_mm)
    }

    /// What is flushed at a change, less so much.
    pub fn flushed(&self, change: &Flush, less_mm3: f64, inside_mm: f64) -> Rows {
        self.rows(change.to, change.mm3 - less_mm3, self.lines, inside_mm)
    }

    /// Depth that the layer needs for a tower so wide.
    pub fn needed_mm(&self, width_mm: f64) -> f64 {
        // A deeper frame takes more, so that the second guess suffices.
        let guess_mm = self.filled_mm(width_mm, 0.0);
        let guess_mm = self.filled_mm(width_mm, self.frame_mm3(width_mm, guess_mm));
        self.filled_mm(width_mm, self.frame_mm3(width_mm, guess_mm))
    }

    /// Depth that all changes take, with the frame; so much of what is flushed most is laid elsewhere.
    fn filled_mm(&self, width_mm: f64, elsewhere_mm3: f64) -> f64 {
        let frame_mm = self.spacing_mm(self.rest);
        let inside_mm = width_mm - 2.0 * frame_mm;
        let depth_mm = |change: &Flush| {
            let less_mm3 = if change.to == self.rest { elsewhere_mm3 } else { 0.0 };
            let rows = [self.rammed(change, inside_mm), self.flushed(change, less_mm3, inside_mm)];
            rows.iter().map(Rows::depth_mm).sum::<f64>()
        };
        self.changes.iter().map(depth_mm).sum::<f64>() + 2.0 * frame_mm
    }

    /// What a frame of this size takes, mm³.
    fn frame_mm3(&self, width_mm: f64, depth_mm: f64) -> f64 {
        let around_mm = 2.0 * (width_mm + depth_mm) - 4.0 * self.spacing_mm(self.rest);
        around_mm * self.area_mm2(self.rest)
    }

    /// Lets the frame, and the lines where nothing is flushed, be what the tool that is flushed most is flushed into.
    pub fn flush_into_frame(&mut self, width_mm: f64, apart_mm: f64) {
        let rest = self.rest;
        let frame_mm3 = self.frame_mm3(width_mm, self.depth_mm);
        let left_mm = self.depth_mm - self.filled_mm(width_mm, frame_mm3) - self.spacing_mm(rest);
        let lines = (width_mm / apart_mm).max(2.0);
        let lines_mm3 = lines * left_mm.max(0.0) * self.area_mm2(rest);
        for change in self.changes.iter_mut().filter(|change| change.to == rest) {
            change.mm3 = (change.mm3 - frame_mm3 - lines_mm3).max(0.0);
        }
    }

    pub fn path(&self, points: Vec<Point>, closed: bool, tool: ToolId, turn: u32) -> Path {
        Path {
            role: Role::PrimeTower,
            closed,
            points,
            width: Width::Constant(self.width_mm(tool)),
            height_mm: self.height_mm,
            island: None,
            phase: Phase::Tower(turn),
            tool: Some(tool),
        }
    }
}

/// Lines between two corners along an axis, joined at their ends, no longer together than a length.
pub(super) fn zigzag(
    low: [f64; 2],
    high: [f64; 2],
    axis: usize,
    lines: usize,
    length_mm: Option<f64>,
) -> Vec<Point> {
    let across = 1 - axis;
    let apart_mm = if lines > 1 { (high[across] - low[across]) / (lines - 1) as f64 } else { 0.0 };
    let mut left_mm = length_mm.unwrap_or(f64::INFINITY);
    let mut points: Vec<[f64; 2]> = Vec::with_capacity(2 * lines);
    for line in 0..lines {
        let ends = if line % 2 == 0 { [low[axis], high[axis]] } else { [high[axis], low[axis]] };
        for end in ends {
            let mut point = [0.0; 2];
            (point[axis], point[across]) = (end, low[across] + line as f64 * apart_mm);
            let Some(&before) = points.last() else {
                points.push(point);
                continue;
            };
            let step_mm = geometry::distance_mm(before, point);
            if step_mm >= left_mm {
                let share = left_mm / step_mm;
                points.push([0, 1].map(|i| before[i] + share * (point[i] - before[i])));
                return rounded(&points);
            }
            left_mm -= step_mm;
            points.push(point);
        }
    }
    rounded(&points)
}

fn rounded(points: &[[f64; 2]]) -> Vec<Point> {
    let mut points: Vec<Point> = points.iter().map(|p| Point::from_mm(p[0], p[1])).collect();
    points.dedup();
    points
}
