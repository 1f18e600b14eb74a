//! The prime tower: where tools are flushed that others follow.

use super::flush::flushed_into_mm3;
use crate::motion::SwapSettings;
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
    width_mm: f64,
    /// Depth, which is less towards the top.
    depth_mm: f64,
    /// The tool that prints what is not flushed: the one that is flushed most, or the one that is in use.
    rest: ToolId,
    changes: Vec<Flush>,
}

/// What a change lays into the tower.
#[derive(Clone, Copy, Debug)]
struct Flush {
    from: ToolId,
    to: ToolId,
    ram: Ram,
    /// What the new tool is flushed with, mm³.
    mm3: f64,
}

/// What ramming lays before a tool is left.
#[derive(Clone, Copy, Debug, Default)]
struct Ram {
    mm3: f64,
    /// Width of its lines and their distance, of the tower's width and of theirs.
    width: f64,
    spacing: f64,
}

impl Floor {
    fn spacing_mm(&self) -> f64 {
        bead::spacing_mm(self.width_mm, self.height_mm)
    }

    fn length_mm(&self, volume_mm3: f64) -> f64 {
        volume_mm3 / bead::area_mm2(self.width_mm, self.height_mm)
    }

    /// Rows that a flush takes, each so long.
    fn rows(&self, volume_mm3: f64, row_mm: f64) -> usize {
        let spacing_mm = self.spacing_mm();
        ((self.length_mm(volume_mm3) + spacing_mm) / (row_mm + spacing_mm)).ceil() as usize
    }

    /// Depth that all changes take, with the frame; so much of what is flushed most is laid elsewhere.
    fn needed_mm(&self, width_mm: f64, elsewhere_mm3: f64) -> f64 {
        let spacing_mm = self.spacing_mm();
        let row_mm = width_mm - 3.0 * spacing_mm;
        let changes_mm: f64 = self
            .changes
            .iter()
            .map(|change| {
                let less_mm3 = if change.to == self.rest { elsewhere_mm3 } else { 0.0 };
                let rows = self.rows((change.mm3 - less_mm3).max(0.0), row_mm);
                self.rammed(change.ram, row_mm).depth_mm() + rows as f64 * spacing_mm
            })
            .sum();
        changes_mm + 2.0 * spacing_mm
    }

    /// What a frame of this size takes, mm³.
    fn frame_mm3(&self, width_mm: f64, depth_mm: f64) -> f64 {
        let around_mm = 2.0 * (width_mm + depth_mm) - 4.0 * self.spacing_mm();
        around_mm * bead::area_mm2(self.width_mm, self.height_mm)
    }

    /// Lets the frame, and the lines where nothing is flushed, be what the tool that is flushed most is flushed into.
    fn flush_into_frame(&mut self, width_mm: f64, apart_mm: f64) {
        let frame_mm3 = self.frame_mm3(width_mm, self.depth_mm);
        let left_mm = self.depth_mm - self.needed_mm(width_mm, frame_mm3) - self.spacing_mm();
        let lines = (width_mm / apart_mm).max(2.0);
        let lines_mm3 = lines * left_mm.max(0.0) * bead::area_mm2(self.width_mm, self.height_mm);
        let rest = self.rest;
        for change in self.changes.iter_mut().filter(|change| change.to == rest) {
            change.mm3 = (change.mm3 - frame_mm3 - lines_mm3).max(0.0);
        }
    }

    /// The lines of ramming, of rows so long.
    fn rammed(&self, ram: Ram, row_mm: f64) -> Rammed {
        let width_mm = self.width_mm * ram.width;
        let length_mm = ram.mm3 / bead::area_mm2(width_mm, self.height_mm).max(f64::MIN_POSITIVE);
        let spacing_mm = bead::spacing_mm(width_mm, self.height_mm) * ram.spacing;
        let rows = ((length_mm + spacing_mm) / (row_mm + spacing_mm)).ceil() as usize;
        Rammed { width_mm, length_mm, spacing_mm, rows }
    }
}

/// Lines of ramming.
struct Rammed {
    width_mm: f64,
    length_mm: f64,
    spacing_mm: f64,
    rows: usize,
}

impl Rammed {
    fn depth_mm(&self) -> f64 {
        self.rows as f64 * self.spacing_mm
    }
}

impl Tower {
    /// The tower for layers whose tools are in order, the first of them in use from the start; `None`: nothing is flushed.
    pub fn plan(layers: &[LayerPaths], settings: &Settings) -> Option<Self> {
        let mut tool = layers.iter().find_map(|layer| layer.tools.first().copied())?;
        let mut below_mm = 0.0;
        let mut floors: Vec<Floor> = Vec::with_capacity(layers.len());
        let rams: Vec<Ram> =
            (0..settings.tools.len()).map(|tool| ram(&settings.of_tool(tool).swap)).collect();
        for layer in layers {
            let mut changes = Vec::new();
            for &next in &layer.tools {
                let mm3 = settings.flush_mm3(tool.into(), next.into()) - flushed_into_mm3(layer, next);
                let ram = rams.get(usize::from(tool)).copied().unwrap_or_default();
                if next != tool && (mm3 > 0.0 || ram.mm3 > 0.0) {
                    changes.push(Flush { from: tool, to: next, ram, mm3: mm3.max(0.0) });
                }
                tool = next;
            }
            let width_mm = floor_width_mm(floors.is_empty(), settings);
            let height_mm = layer.top_mm - below_mm;
            let first = layer.tools.first().copied().unwrap_or(tool);
            let most = changes.iter().max_by(|a: &&Flush, b| a.mm3.total_cmp(&b.mm3));
            let rest = most.map_or(first, |change| change.to);
            floors.push(Floor { height_mm, width_mm, depth_mm: 0.0, rest, changes });
            below_mm = layer.top_mm;
        }
        let last = floors.iter().rposition(|floor| !floor.changes.is_empty())?;
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
        let rams = tools.iter().map(|tool| ram(&settings.of_tool(*tool).swap));
        let ram = rams.max_by(|a, b| a.mm3.total_cmp(&b.mm3)).unwrap_or_default();
        let change = |mm3| Flush { from: 0, to: 0, ram, mm3 };
        let changes: Vec<Flush> = flushes.into_iter().map(change).collect();
        let layer = &settings.layer;
        let least_mm = if layer.adaptive { layer.min_height.0 } else { layer.height.0 };
        let heights_mm = [layer.first_height.0, least_mm];
        let floor = |(index, height_mm): (usize, f64)| Floor {
            height_mm,
            width_mm: floor_width_mm(index == 0, settings),
            depth_mm: 0.0,
            rest: ToolId::MAX,
            changes: changes.clone(),
        };
        let floors: Vec<Floor> = heights_mm.into_iter().enumerate().map(floor).collect();
        Some(Self::of(floors, height_mm, settings))
    }

    fn of(mut layers: Vec<Floor>, height_mm: f64, settings: &Settings) -> Self {
        let tower = &settings.prime_tower;
        let least_mm = LEAST_DEPTH_MM.max(LEAST_SLENDERNESS * height_mm);
        let width_mm = tower.width.0;
        let mut depth_mm = least_mm;
        for (index, floor) in layers.iter_mut().enumerate().rev() {
            // A deeper frame takes more, so that the second guess suffices.
            let guess_mm = floor.needed_mm(width_mm, 0.0);
            let guess_mm = floor.needed_mm(width_mm, floor.frame_mm3(width_mm, guess_mm));
            let needed_mm = floor.needed_mm(width_mm, floor.frame_mm3(width_mm, guess_mm));
            depth_mm = depth_mm.max(needed_mm);
            floor.depth_mm = depth_mm;
            let apart_mm = if index == 0 { floor.spacing_mm() } else { tower.line_distance.0 };
            floor.flush_into_frame(width_mm, apart_mm);
        }
        Self {
            center_mm: [0.0; 2],
            size_mm: [width_mm, depth_mm],
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
        Polygon { outer: self.rectangle(self.size_mm[1], -self.brim_mm), holes: Vec::new() }
    }

    /// Its paths in a layer, and what is laid while tools are left.
    pub fn paths(&self, layer: usize) -> (Vec<Path>, Vec<Path>) {
        let Some(floor) = self.layers.get(layer) else { return Default::default() };
        let spacing_mm = floor.spacing_mm();
        let low = [0, 1].map(|i| self.center_mm[i] - self.size_mm[i] / 2.0 + 1.5 * spacing_mm);
        let depth_mm = floor.depth_mm;
        let size_mm = [self.size_mm[0], depth_mm];
        let high = [0, 1].map(|i| low[i] + size_mm[i] - 3.0 * spacing_mm);
        let (mut paths, mut rams) = (Vec::new(), Vec::new());
        let mut y_mm = low[1];
        for &Flush { from, to, ram, mm3 } in &floor.changes {
            let rammed = floor.rammed(ram, high[0] - low[0]);
            if rammed.rows > 0 {
                let at_mm = y_mm + (rammed.spacing_mm - spacing_mm) / 2.0;
                let top_mm = at_mm + (rammed.rows - 1) as f64 * rammed.spacing_mm;
                let points =
                    zigzag([low[0], at_mm], [high[0], top_mm], 0, rammed.rows, Some(rammed.length_mm));
                let width = Width::Constant(rammed.width_mm);
                rams.push(Path { width, ..floor.path(points, false, from, 0) });
                y_mm += rammed.depth_mm();
            }
            let rows = floor.rows(mm3, high[0] - low[0]);
            if rows > 0 {
                let top_mm = y_mm + (rows - 1) as f64 * spacing_mm;
                let points = zigzag([low[0], y_mm], [high[0], top_mm], 0, rows, Some(floor.length_mm(mm3)));
                paths.push(floor.path(points, false, to, 0));
                y_mm += rows as f64 * spacing_mm;
            }
        }
        for loop_number in 0..self.brim_loops(layer, spacing_mm) {
            let ring = self.rectangle(depth_mm, -(loop_number as f64 + 0.5) * spacing_mm);
            paths.push(floor.path(ring, true, floor.rest, 1));
        }
        paths.push(floor.path(self.rectangle(depth_mm, 0.5 * spacing_mm), true, floor.rest, 1));
        if high[1] - y_mm >= spacing_mm {
            let apart_mm = if layer == 0 { spacing_mm } else { self.line_distance_mm };
            let lines = ((high[0] - low[0]) / apart_mm).floor() as usize + 1;
            let points = zigzag([low[0], y_mm], high, 1, lines.max(2), None);
            paths.push(floor.path(points, false, floor.rest, 2));
        }
        (paths, rams)
    }

    fn brim_loops(&self, layer: usize, spacing_mm: f64) -> usize {
        if layer == 0 { (self.brim_mm / spacing_mm).round() as usize } else { 0 }
    }

    /// The outline where it is so deep, so far inside.
    fn rectangle(&self, depth_mm: f64, inset_mm: f64) -> Vec<Point> {
        let low = [0, 1].map(|i| self.center_mm[i] - self.size_mm[i] / 2.0);
        let size_mm = [self.size_mm[0], depth_mm];
        let corner = |ends: [bool; 2]| {
            let at = |i: usize| low[i] + if ends[i] { size_mm[i] - inset_mm } else { inset_mm };
            Point::from_mm(at(0), at(1))
        };
        [[false, false], [true, false], [true, true], [false, true]].map(corner).to_vec()
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

/// What a filament is rammed with.
fn ram(swap: &SwapSettings) -> Ram {
    Ram { mm3: swap.rammed_mm3(), width: swap.ramming_width.0, spacing: swap.ramming_spacing.0 }
}

fn floor_width_mm(is_first: bool, settings: &Settings) -> f64 {
    let own_mm = settings.first_layer.width.0;
    if is_first && own_mm > 0.0 { own_mm } else { settings.walls.width.0 }
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
            width: Width::Constant(self.width_mm),
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
