//! The prime tower: where tools are flushed that others follow.

use super::floor::{Floor, Flush, Lines, Ram, Rows, zigzag};
use super::flush::flushed_into_mm3;
use crate::profile::Settings;
use crate::toolpath::{LayerPaths, Path, Width};
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

impl Tower {
    /// The tower for layers whose tools are in order, the first of them in use from the start; `None`: nothing is flushed.
    /// `widths_mm`: of the lines of each tool, on the first layer and on others.
    pub fn plan(layers: &[LayerPaths], widths_mm: &[Vec<f64>; 2], settings: &Settings) -> Option<Self> {
        let mut tool = layers.iter().find_map(|layer| layer.tools.first().copied())?;
        let mut below_mm = 0.0;
        let mut floors: Vec<Floor> = Vec::with_capacity(layers.len());
        let rams: Vec<Ram> =
            (0..settings.tools.len()).map(|tool| Ram::from(&settings.of_tool(tool).swap)).collect();
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
            let widths_mm = widths_mm[usize::from(!floors.is_empty())].clone();
            let height_mm = layer.top_mm - below_mm;
            let first = layer.tools.first().copied().unwrap_or(tool);
            let most = changes.iter().max_by(|a: &&Flush, b| a.mm3.total_cmp(&b.mm3));
            let rest = most.map_or(first, |change| change.to);
            let lines = Lines::of_flushes(floors.is_empty(), settings);
            floors.push(Floor { height_mm, widths_mm, depth_mm: 0.0, rest, lines, changes });
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
        let rams = tools.iter().map(|tool| Ram::from(&settings.of_tool(*tool).swap));
        let ram = rams.max_by(|a, b| a.mm3.total_cmp(&b.mm3)).unwrap_or_default();
        let changes: Vec<Flush> = flushes.into_iter().map(|mm3| Flush { from: 0, to: 1, ram, mm3 }).collect();
        let layer = &settings.layer;
        let least_mm = if layer.adaptive { layer.min_height.0 } else { layer.height.0 };
        let heights_mm = [layer.first_height.0, least_mm];
        // How wide lines are matters little: as much narrower, as many more of them there are.
        let floor = |(is_first, (height_mm, widths_mm))| {
            let (lines, changes) = (Lines::of_flushes(is_first, settings), changes.clone());
            Floor { height_mm, widths_mm, depth_mm: 0.0, rest: 0, lines, changes }
        };
        let sizes = heights_mm.into_iter().zip(settings.widths_beside_mm());
        let floors = [true, false].into_iter().zip(sizes).map(floor).collect();
        Some(Self::of(floors, height_mm, settings))
    }

    fn of(mut layers: Vec<Floor>, height_mm: f64, settings: &Settings) -> Self {
        let tower = &settings.prime_tower;
        let least_mm = LEAST_DEPTH_MM.max(LEAST_SLENDERNESS * height_mm);
        let width_mm = tower.width.0;
        let mut depth_mm = least_mm;
        for (index, floor) in layers.iter_mut().enumerate().rev() {
            depth_mm = depth_mm.max(floor.needed_mm(width_mm));
            floor.depth_mm = depth_mm;
            let apart_mm = if index == 0 { floor.spacing_mm(floor.rest) } else { tower.line_distance.0 };
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
        let (depth_mm, spacing_mm) = (floor.depth_mm, floor.spacing_mm(floor.rest));
        let corner_mm = [0, 1].map(|i| self.center_mm[i] - self.size_mm[i] / 2.0);
        // Inside of the frame.
        let inner = [
            corner_mm.map(|mm| mm + spacing_mm),
            [corner_mm[0] + self.size_mm[0] - spacing_mm, corner_mm[1] + depth_mm - spacing_mm],
        ];
        let inside_mm = inner[1][0] - inner[0][0];
        let zigzag_of = |rows: &Rows, y_mm: f64| {
            let [left, right] = [inner[0][0] + rows.line_mm / 2.0, inner[1][0] - rows.line_mm / 2.0];
            let first_mm = y_mm + rows.spacing_mm / 2.0;
            let top_mm = first_mm + (rows.count - 1) as f64 * rows.spacing_mm;
            zigzag([left, first_mm], [right, top_mm], 0, rows.count, Some(rows.length_mm))
        };
        let (mut paths, mut rams) = (Vec::new(), Vec::new());
        let mut y_mm = inner[0][1];
        for change in &floor.changes {
            let (rammed, flushed) = (floor.rammed(change, inside_mm), floor.flushed(change, 0.0, inside_mm));
            for (tool, rows, laid) in [(change.from, rammed, &mut rams), (change.to, flushed, &mut paths)] {
                if rows.count > 0 {
                    let width = Width::Constant(rows.width_mm);
                    laid.push(Path { width, ..floor.path(zigzag_of(&rows, y_mm), false, tool, 0) });
                    y_mm += rows.depth_mm();
                }
            }
        }
        let low = [inner[0][0] + spacing_mm / 2.0, y_mm + spacing_mm / 2.0];
        let high = inner[1].map(|mm| mm - spacing_mm / 2.0);
        for loop_number in 0..self.brim_loops(layer, spacing_mm) {
            let ring = self.rectangle(depth_mm, -(loop_number as f64 + 0.5) * spacing_mm);
            paths.push(floor.path(ring, true, floor.rest, 1));
        }
        paths.push(floor.path(self.rectangle(depth_mm, 0.5 * spacing_mm), true, floor.rest, 1));
        if high[1] - low[1] >= spacing_mm {
            let apart_mm = if layer == 0 { spacing_mm } else { self.line_distance_mm };
            let lines = ((high[0] - low[0]) / apart_mm).floor() as usize + 1;
            let points = zigzag(low, high, 1, lines.max(2), None);
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
        let excluded = settings.bed.excluded();
        if let Some(middle_mm) = room {
            self.center_mm = middle_mm;
            let footprint = self.footprint();
            let is_on_bed = settings.bed.excess_mm(footprint.outer.iter().map(|p| p.mm())) <= 0.0;
            let taken =
                geometry::intersection(&Region::from(footprint), &geometry::union(standing, &excluded));
            if is_on_bed && taken.is_empty() {
                return true;
            }
        }
        let bed = &settings.bed;
        let (low, high, middle) = (bed.low_mm(), bed.high_mm(), bed.middle_mm());
        let round_mm = (bed.shape == crate::plate::BedShape::Round).then_some(bed.size[0].0 / 2.0);
        let kept_free = geometry::union(&geometry::offset(printed, CLEAR_MM), &excluded);
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
pub(super) const CLEAR_MM: f64 = 3.0;
/// Distance from the edge of the bed, where start scripts prime, millimetres.
const EDGE_MM: f64 = 6.0;
/// Places are looked for so far apart, millimetres.
const STEP_MM: f64 = 3.0;
