//! The prime tower: where tools are flushed that others follow.

use super::flush::flushed_into_mm3;
use crate::profile::Settings;
use crate::toolpath::{LayerPaths, Path, Phase, Role, ToolId, Width, bead};
use geometry::{Point, Polygon, Region};

/// Depth of a tower that flushes little, millimetres; a high one is deeper.
const LEAST_DEPTH_MM: f64 = 8.0;

/// Depth of a tower as a share of its height: what stands on the bed without being knocked over.
const LEAST_SLENDERNESS: f64 = 0.12;

/// A prime tower.
#[derive(Clone, Debug)]
pub(crate) struct Tower {
    /// Middle on the bed, once it is placed, millimetres.
    pub center_mm: [f64; 2],
    /// Width and depth, without the brim, millimetres.
    pub size_mm: [f64; 2],
    brim_mm: f64,
    line_distance_mm: f64,
    layers: Vec<Floor>,
}

/// One layer of it.
#[derive(Clone, Debug)]
struct Floor {
    height_mm: f64,
    /// Of the lines of each tool.
    widths_mm: Vec<f64>,
    /// The tool that the layer begins with.
    first: ToolId,
    /// The tools that are flushed, and how much of each, mm³.
    flushes: Vec<(ToolId, f64)>,
}

impl Floor {
    fn width_mm(&self, tool: ToolId) -> f64 {
        self.widths_mm[usize::from(tool)]
    }

    fn spacing_mm(&self, tool: ToolId) -> f64 {
        bead::spacing_mm(self.width_mm(tool), self.height_mm)
    }

    fn length_mm(&self, tool: ToolId, volume_mm3: f64) -> f64 {
        volume_mm3 / bead::area_mm2(self.width_mm(tool), self.height_mm)
    }

    /// Rows that a flush takes, each so long.
    fn rows(&self, tool: ToolId, volume_mm3: f64, row_mm: f64) -> usize {
        let spacing_mm = self.spacing_mm(tool);
        ((self.length_mm(tool, volume_mm3) + spacing_mm) / (row_mm + spacing_mm)).ceil() as usize
    }

    /// Depth that all flushes take within a frame.
    fn depth_mm(&self, width_mm: f64) -> f64 {
        let frame_mm = self.spacing_mm(self.first);
        let depth_mm = |&(tool, mm3): &(ToolId, f64)| {
            let spacing_mm = self.spacing_mm(tool);
            self.rows(tool, mm3, width_mm - 2.0 * frame_mm - spacing_mm) as f64 * spacing_mm
        };
        self.flushes.iter().map(depth_mm).sum::<f64>() + 2.0 * frame_mm
    }
}

impl Tower {
    /// The tower for layers whose tools are in order, the first of them in use from the start; `None`: nothing is flushed.
    /// `widths_mm`: of the lines of each tool, on the first layer and on others.
    pub fn plan(layers: &[LayerPaths], widths_mm: &[Vec<f64>; 2], settings: &Settings) -> Option<Self> {
        let mut tool = layers.iter().find_map(|layer| layer.tools.first().copied())?;
        let mut below_mm = 0.0;
        let mut floors: Vec<Floor> = Vec::with_capacity(layers.len());
        for layer in layers {
            let mut flushes = Vec::new();
            for &next in &layer.tools {
                let mm3 = settings.flush_mm3(tool.into(), next.into()) - flushed_into_mm3(layer, next);
                if next != tool && mm3 > 0.0 {
                    flushes.push((next, mm3));
                }
                tool = next;
            }
            let widths_mm = widths_mm[usize::from(!floors.is_empty())].clone();
            let height_mm = layer.top_mm - below_mm;
            let first = layer.tools.first().copied().unwrap_or(tool);
            floors.push(Floor { height_mm, widths_mm, first, flushes });
            below_mm = layer.top_mm;
        }
        let last = floors.iter().rposition(|floor| !floor.flushes.is_empty())?;
        floors.truncate(last + 1);
        let height_mm: f64 = floors.iter().map(|floor| floor.height_mm).sum();
        Some(Self::of(floors, height_mm, settings))
    }

    /// A tower as large as one can be in which each of so many changes of a layer leads to another of these tools, and which is so
    /// high; `None`: there is nothing to flush.
    pub fn largest(tools: &[usize], changes: usize, height_mm: f64, settings: &Settings) -> Option<Self> {
        let most = |to: &usize| {
            let from = tools.iter().filter(|from| *from != to);
            from.map(|from| settings.flush_mm3(*from, *to)).fold(0.0, f64::max)
        };
        let mut flushes: Vec<f64> = tools.iter().map(most).filter(|mm3| *mm3 > 0.0).collect();
        flushes.sort_by(|a, b| b.total_cmp(a));
        flushes.truncate(changes);
        if flushes.is_empty() {
            return None;
        }
        let flushes: Vec<(ToolId, f64)> = flushes.into_iter().map(|mm3| (0, mm3)).collect();
        let layer = &settings.layer;
        let least_mm = if layer.adaptive { layer.min_height.0 } else { layer.height.0 };
        let heights_mm = [layer.first_height.0, least_mm];
        // How wide lines are matters little: as much narrower, as many more of them there are.
        let floor =
            |(height_mm, widths_mm)| Floor { height_mm, widths_mm, first: 0, flushes: flushes.clone() };
        let floors = heights_mm.into_iter().zip(settings.widths_beside_mm()).map(floor).collect();
        Some(Self::of(floors, height_mm, settings))
    }

    fn of(layers: Vec<Floor>, height_mm: f64, settings: &Settings) -> Self {
        let tower = &settings.prime_tower;
        let least_mm = LEAST_DEPTH_MM.max(LEAST_SLENDERNESS * height_mm);
        let depth_mm = layers.iter().map(|floor| floor.depth_mm(tower.width.0)).fold(least_mm, f64::max);
        Self {
            center_mm: [0.0; 2],
            size_mm: [tower.width.0, depth_mm],
            brim_mm: tower.brim.0,
            line_distance_mm: tower.line_distance.0,
            layers,
        }
    }

    /// Width and depth with the brim, millimetres.
    pub fn outer_mm(&self) -> [f64; 2] {
        self.size_mm.map(|size_mm| size_mm + 2.0 * self.brim_mm)
    }

    /// What it covers on the bed, brim included.
    pub fn footprint(&self) -> Polygon {
        Polygon { outer: self.rectangle(-self.brim_mm), holes: Vec::new() }
    }

    /// Its paths in a layer.
    pub fn paths(&self, layer: usize) -> Vec<Path> {
        let Some(floor) = self.layers.get(layer) else { return Vec::new() };
        let spacing_mm = floor.spacing_mm(floor.first);
        let inner = [-1.0, 1.0]
            .map(|side| [0, 1].map(|i| self.center_mm[i] + side * (self.size_mm[i] / 2.0 - spacing_mm)));
        let mut paths = Vec::new();
        let mut y_mm = inner[0][1];
        for &(tool, mm3) in &floor.flushes {
            let own_mm = floor.spacing_mm(tool);
            let [left, right] = [inner[0][0] + own_mm / 2.0, inner[1][0] - own_mm / 2.0];
            let rows = floor.rows(tool, mm3, right - left);
            let first_mm = y_mm + own_mm / 2.0;
            let top_mm = first_mm + (rows - 1) as f64 * own_mm;
            let points = zigzag([left, first_mm], [right, top_mm], 0, rows, Some(floor.length_mm(tool, mm3)));
            paths.push(floor.path(points, false, tool, 0));
            y_mm += rows as f64 * own_mm;
        }
        let low = [inner[0][0] + spacing_mm / 2.0, y_mm + spacing_mm / 2.0];
        let high = inner[1].map(|mm| mm - spacing_mm / 2.0);
        for loop_number in 0..self.brim_loops(layer, spacing_mm) {
            let ring = self.rectangle(-(loop_number as f64 + 0.5) * spacing_mm);
            paths.push(floor.path(ring, true, floor.first, 1));
        }
        paths.push(floor.path(self.rectangle(0.5 * spacing_mm), true, floor.first, 1));
        if high[1] - low[1] >= spacing_mm {
            let apart_mm = if layer == 0 { spacing_mm } else { self.line_distance_mm };
            let lines = ((high[0] - low[0]) / apart_mm).floor() as usize + 1;
            let points = zigzag(low, high, 1, lines.max(2), None);
            paths.push(floor.path(points, false, floor.first, 2));
        }
        paths
    }

    fn brim_loops(&self, layer: usize, spacing_mm: f64) -> usize {
        if layer == 0 { (self.brim_mm / spacing_mm).round() as usize } else { 0 }
    }

    /// Its outline, so far inside.
    fn rectangle(&self, inset_mm: f64) -> Vec<Point> {
        let half = self.size_mm.map(|size_mm| size_mm / 2.0 - inset_mm);
        let corner = |[x, y]: [f64; 2]| {
            Point::from_mm(self.center_mm[0] + x * half[0], self.center_mm[1] + y * half[1])
        };
        [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(corner).to_vec()
    }

    /// Moves it to the middle of the bed's part that is nearest to what is printed and clear of it; whether there is one.
    /// `room`: the middle of the room that was kept for it, within the skirt and so clear of what is `standing` only.
    pub fn place(
        &mut self,
        printed: &Region,
        standing: &Region,
        room: Option<[f64; 2]>,
        settings: &Settings,
    ) -> bool {
        if let Some(middle_mm) = room {
            self.center_mm = middle_mm;
            let footprint = self.footprint();
            let is_on_bed = settings.bed.excess_mm(footprint.outer.iter().map(|p| p.mm())) <= 0.0;
            let taken = geometry::intersection(&Region::from(footprint), standing);
            if is_on_bed && taken.is_empty() {
                return true;
            }
        }
        let bed = &settings.bed;
        let (low, high, middle) = (bed.low_mm(), bed.high_mm(), bed.middle_mm());
        let round_mm = (bed.shape == crate::plate::BedShape::Round).then_some(bed.size[0].0 / 2.0);
        let kept_free = geometry::offset(printed, CLEAR_MM);
        let wanted = match printed.bounds() {
            Some(bounds) => {
                let (a, b) = (bounds.min.mm(), bounds.max.mm());
                [0, 1].map(|i| f64::midpoint(a[i], b[i]))
            }
            None => middle,
        };
        let reach = self.size_mm.map(|size_mm| size_mm / 2.0 + self.brim_mm);
        let fits = |at: [f64; 2]| {
            let inside =
                (0..2).all(|i| at[i] - reach[i] >= low[i] + EDGE_MM && at[i] + reach[i] <= high[i] - EDGE_MM);
            let far = [0, 1].map(|i| (at[i] - middle[i]).abs() + reach[i]);
            inside
                && round_mm
                    .is_none_or(|radius_mm| geometry::real::hypot(far[0], far[1]) <= radius_mm - EDGE_MM)
        };
        let clear =
            |tower: &Self| geometry::intersection(&Region::from(tower.footprint()), &kept_free).is_empty();
        if let [x, y] = settings.prime_tower.position[..] {
            self.center_mm = [x, y];
            return fits(self.center_mm) && clear(self);
        }
        let steps = [0, 1].map(|i| ((high[i] - low[i]) / STEP_MM) as i64);
        let mut places: Vec<(f64, [f64; 2])> = Vec::new();
        for column in 0..=steps[0] {
            for row in 0..=steps[1] {
                let at = [low[0] + column as f64 * STEP_MM, low[1] + row as f64 * STEP_MM];
                if fits(at) {
                    places.push((geometry::distance_mm(at, wanted), at));
                }
            }
        }
        places.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (_, at) in places {
            self.center_mm = at;
            if clear(self) {
                return true;
            }
        }
        false
    }
}

/// Distance from all that is printed, millimetres.
const CLEAR_MM: f64 = 3.0;
/// Distance from the edge of the bed, where start scripts prime, millimetres.
const EDGE_MM: f64 = 6.0;
/// Places are looked for so far apart, millimetres.
const STEP_MM: f64 = 3.0;

impl Floor {
    fn path(&self, points: Vec<Point>, closed: bool, tool: ToolId, turn: u32) -> Path {
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
fn zigzag(low: [f64; 2], high: [f64; 2], axis: usize, lines: usize, length_mm: Option<f64>) -> Vec<Point> {
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
