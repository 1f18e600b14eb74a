//! Priming: lines at an edge of the bed on which each tool is loaded and flushed before the first layer.

use super::floor::{Floor, Flush, Lines, Ram, Rows, zigzag};
use super::tower::CLEAR_MM;
use crate::plate::BedShape;
use crate::profile::Settings;
use crate::toolpath::{LayerKind, LayerPaths, Path, ToolId, Turn, Width};
use geometry::{Point, Polygon, Region};

/// What tells that filament arrives, of a tool that another follows, mm³.
const ARRIVED_MM3: f64 = 20.0;
/// Widest place of a tool, millimetres.
const WIDEST_MM: f64 = 60.0;
/// Width of all places, as a share of the bed's; of a round one's diameter, of which a chord near the edge is shorter.
const SHARE: f64 = 0.9;
const SHARE_OF_ROUND: f64 = 0.6;
/// Distance from the edge of the bed, millimetres.
const EDGE_MM: f64 = 1.0;

/// Lines that prime tools, one place beside the other.
#[derive(Debug)]
pub(crate) struct Priming {
    /// The tools in their order; the last one prints the first layer's beginning.
    pub tools: Vec<ToolId>,
    /// What they cover on the bed.
    pub covered: Polygon,
    paths: Vec<Path>,
    rams: Vec<Path>,
    top_mm: f64,
}

/// The tools in the order in which they are primed: the one that prints first is the last, and what it takes to flush the one before
/// it out is least.
pub(crate) fn order(used: &[ToolId], first: ToolId, settings: &Settings) -> Vec<ToolId> {
    let mut others: Vec<ToolId> = used.iter().copied().filter(|tool| *tool != first).collect();
    let flush_mm3 = |tool: ToolId| settings.flush_mm3(tool.into(), first.into());
    let before = (0..others.len()).min_by(|a, b| flush_mm3(others[*a]).total_cmp(&flush_mm3(others[*b])));
    if let Some(before) = before {
        let before = others.remove(before);
        others.push(before);
    }
    others.push(first);
    others
}

impl Priming {
    /// The lines for tools in their order, at the front edge of the bed, or else at the back edge, clear of what is taken; `None`:
    /// there is room at neither. `widths_mm`: of the lines of each tool.
    pub fn plan(
        tools: Vec<ToolId>,
        top_mm: f64,
        widths_mm: &[f64],
        taken: &Region,
        settings: &Settings,
    ) -> Option<Self> {
        let bed = &settings.bed;
        let (low, high, middle) = (bed.low_mm(), bed.high_mm(), bed.middle_mm());
        let [width_mm, depth_mm] = [0, 1].map(|i| high[i] - low[i]);
        let round = bed.shape == BedShape::Round;
        let share = if round { SHARE_OF_ROUND } else { SHARE };
        let each_mm = (share * width_mm / tools.len() as f64).min(WIDEST_MM);
        let whole_mm = each_mm * tools.len() as f64;
        let left_mm =
            if round { middle[0] - whole_mm / 2.0 } else { low[0] + (1.0 - share) / 2.0 * width_mm };
        // How far the edge is from the box around the bed, over the ends of the lines.
        let radius_mm = width_mm / 2.0;
        let chord_mm = (radius_mm * radius_mm - whole_mm * whole_mm / 4.0).max(0.0).sqrt();
        let bulge_mm = if round { radius_mm - chord_mm } else { 0.0 };
        let rest = *tools.last()?;
        let floor = Floor {
            height_mm: top_mm,
            widths_mm: widths_mm.to_vec(),
            depth_mm: 0.0,
            rest,
            lines: Lines::of_flushes(true, settings),
            changes: Vec::new(),
        };
        let kept_free = geometry::union(&geometry::offset(taken, CLEAR_MM), &bed.excluded());
        let flushes = flushes(&tools, settings);
        [1.0, -1.0].into_iter().find_map(|inwards| {
            let edge_mm = if inwards > 0.0 { low[1] } else { high[1] };
            let start_mm = edge_mm + inwards * (bulge_mm + EDGE_MM);
            let mut priming = Self {
                tools: tools.clone(),
                covered: Polygon::default(),
                paths: Vec::new(),
                rams: Vec::new(),
                top_mm,
            };
            let mut deepest_mm = 0.0_f64;
            for (place, flush) in flushes.iter().enumerate() {
                let from_mm = left_mm + place as f64 * each_mm;
                deepest_mm =
                    deepest_mm.max(priming.lay(flush, [from_mm, start_mm], each_mm, inwards, &floor));
            }
            let end_mm = start_mm + inwards * deepest_mm;
            let [y0, y1] = [start_mm.min(end_mm), start_mm.max(end_mm)];
            let corners = [[left_mm, y0], [left_mm + whole_mm, y0], [left_mm + whole_mm, y1], [left_mm, y1]];
            let outer = corners.map(|[x, y]| Point::from_mm(x, y)).to_vec();
            priming.covered = Polygon { outer, holes: Vec::new() };
            let is_free =
                geometry::intersection(&Region::from(priming.covered.clone()), &kept_free).is_empty();
            (is_free && deepest_mm <= depth_mm / 2.0 && bed.excess_mm(corners.into_iter()) <= 0.0)
                .then_some(priming)
        })
    }

    /// Lays what a tool is flushed with and, after it, what it is rammed with, from a corner inwards; returns the depth of both.
    fn lay(&mut self, flush: &Flush, from: [f64; 2], each_mm: f64, inwards: f64, floor: &Floor) -> f64 {
        let tool = flush.to;
        // Places are a line apart.
        let inside_mm = each_mm - floor.spacing_mm(tool);
        let zigzag_of = |rows: &Rows, depth_mm: f64| {
            let [left, right] = [from[0] + rows.line_mm / 2.0, from[0] + inside_mm - rows.line_mm / 2.0];
            let first_mm = from[1] + inwards * (depth_mm + rows.spacing_mm / 2.0);
            let last_mm = first_mm + inwards * (rows.count - 1) as f64 * rows.spacing_mm;
            zigzag([left, first_mm], [right, last_mm], 0, rows.count, Some(rows.length_mm))
        };
        let (flushed, rammed) = (floor.flushed(flush, 0.0, inside_mm), floor.rammed(flush, inside_mm));
        let mut depth_mm = 0.0;
        for (rows, laid) in [(flushed, &mut self.paths), (rammed, &mut self.rams)] {
            if rows.count > 0 {
                let width = Width::Constant(rows.width_mm);
                laid.push(Path { width, ..floor.path(zigzag_of(&rows, depth_mm), false, tool, 0) });
                depth_mm += rows.depth_mm();
            }
        }
        depth_mm
    }

    /// Its layer, which comes before all others.
    pub fn layer(&self) -> LayerPaths {
        LayerPaths {
            index: 0,
            top_mm: self.top_mm,
            height_mm: self.top_mm,
            islands: Vec::new(),
            paths: self.paths.clone(),
            outline: Region::default(),
            beneath: None,
            kind: LayerKind::Flat,
            entries: Default::default(),
            tools: self.tools.clone(),
            rams: self.rams.clone(),
            turn: Turn { primes: true, ..Turn::default() },
        }
    }
}

/// What each tool is flushed with before the next one is taken, and rammed with; the last one until nothing of the one before it is left.
fn flushes(tools: &[ToolId], settings: &Settings) -> Vec<Flush> {
    let flush = |place: usize| {
        let own = tools[place];
        let (from, last) = (tools[place.saturating_sub(1)], place + 1 == tools.len());
        let ram = if last { Ram::default() } else { Ram::from(&settings.of_tool(own.into()).swap) };
        let mm3 = if last { settings.flush_mm3(from.into(), own.into()) } else { 0.0 };
        Flush { from: own, to: own, ram, mm3: mm3.max(ARRIVED_MM3) }
    };
    (0..tools.len()).map(flush).collect()
}
