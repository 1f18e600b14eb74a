//! Blocks of layers that each tool prints at once, before another is taken, where what other tools print stands apart.

use std::collections::BTreeMap;
use std::ops::Range;

use super::sections::hull_mm;
use crate::gcode::ToolChangeKind;
use crate::motion::{MotionSettings, PauseAt, least_s};
use crate::profile::Settings;
use crate::toolpath::{LayerKind, LayerPaths, Path, Role, ToolId, Turn};
use crate::units::Seconds;
use geometry::{Point, Region, Ring};

/// Objects so far apart are clear of what is wider than the nozzle's tip where one of them is half a millimetre higher: most
/// nozzles are flat for 0.5 mm around their middle and widen by less than 60° from the vertical, to 1.4 mm.
const APART_MM: f64 = 2.0;

/// A block: layers, by their number.
pub(crate) type Block = Range<usize>;

/// Finds the blocks of a print, which are as high as `tool_change.ahead` lets a tool be ahead of others; a layer by itself is one, too.
/// `into_print`: whether tools are flushed into more than the tower. `stops`: where the print waits for somebody, who expects all of
/// the layers before to be there. By a machine whose other nozzles pass over what stands, all tools print layer by layer.
pub(crate) fn find(
    layers: &[LayerPaths],
    into_print: bool,
    stops: [&[PauseAt]; 2],
    settings: &Settings,
) -> Vec<Block> {
    let change = &settings.tool_change;
    let ahead_mm = change.ahead.0;
    if ahead_mm <= 0.0 || into_print || change.ooze_shield || change.kind == ToolChangeKind::Heads {
        return (0..layers.len()).map(|layer| layer..layer + 1).collect();
    }
    // Where the first layers have temperatures and fans of their own, they come one after the other.
    let steady = settings.cooling.full_fan_layer.max(settings.cooling.fan_off_layers).max(2) as usize;
    let steadily = |layer: &LayerPaths| if layer.index < steady { None } else { standing(layer) };
    let mut blocks: Vec<Block> = Vec::new();
    let mut next = 0;
    while let Some(first) = layers.get(next) {
        let mut end = next + 1;
        if let Some(mut block) = steadily(first) {
            let is_stop = |layer: &LayerPaths| {
                let mut stops = stops.into_iter().flatten();
                stops.any(|stop| stop.precedes(layer.index, layer.top_mm, layer.height_mm))
            };
            let fits =
                |layer: &&LayerPaths| layer.top_mm - first.top_mm <= ahead_mm + 1e-6 && !is_stop(layer);
            while let Some(more) = layers.get(end).filter(fits).and_then(steadily) {
                if !join(&mut block, more) || !are_apart(&block) {
                    break;
                }
                end += 1;
            }
        }
        blocks.push(next..end);
        next = end;
    }
    blocks
}

/// An object in some layers.
struct Standing {
    tool: ToolId,
    /// The convex hull of its lines, millimetres.
    hull_mm: Vec<[f64; 2]>,
    /// The widest of them.
    line_mm: f64,
}

/// The objects in a layer; `None`: one has several tools, or there is something that belongs to none.
fn standing(layer: &LayerPaths) -> Option<BTreeMap<u32, Standing>> {
    let mut objects: BTreeMap<u32, Standing> = BTreeMap::new();
    for path in &layer.paths {
        let object = layer.islands.get(path.island?.index())?.object;
        let tool = path.tool?;
        let new = || Standing { tool, hull_mm: Vec::new(), line_mm: 0.0 };
        let known = objects.entry(object).or_insert_with(new);
        if known.tool != tool {
            return None;
        }
        known.hull_mm.extend(path.points.iter().map(|point| point.mm()));
        known.line_mm = known.line_mm.max(path.width.widest_mm());
    }
    for object in objects.values_mut() {
        object.hull_mm = hull_mm(std::mem::take(&mut object.hull_mm).into_iter(), 0.0);
    }
    (layer.kind == LayerKind::Flat).then_some(objects)
}

/// Adds objects of another layer; whether each has the tool that it had.
fn join(block: &mut BTreeMap<u32, Standing>, more: BTreeMap<u32, Standing>) -> bool {
    let mut same = true;
    for (object, more) in more {
        match block.get_mut(&object) {
            Some(known) => {
                same &= known.tool == more.tool;
                known.line_mm = known.line_mm.max(more.line_mm);
                let all = std::mem::take(&mut known.hull_mm).into_iter().chain(more.hull_mm);
                known.hull_mm = hull_mm(all, 0.0);
            }
            None => {
                block.insert(object, more);
            }
        }
    }
    same
}

/// Whether the objects of different tools are far enough from each other.
fn are_apart(block: &BTreeMap<u32, Standing>) -> bool {
    let grown = |object: &Standing| {
        let ring: Ring = object.hull_mm.iter().map(|[x, y]| Point::from_mm(*x, *y)).collect();
        geometry::offset(&geometry::unite_rings(&[ring]), (APART_MM + object.line_mm) / 2.0)
    };
    // A single line has no hull.
    if block.values().any(|object| object.hull_mm.len() < 3) {
        return false;
    }
    let objects: Vec<(ToolId, Region)> = block.values().map(|object| (object.tool, grown(object))).collect();
    let mut pairs = (1..objects.len()).flat_map(|a| (0..a).map(move |b| (a, b)));
    pairs.all(|(a, b)| {
        objects[a].0 == objects[b].0 || geometry::intersection(&objects[a].1, &objects[b].1).is_empty()
    })
}

/// A part of a layer, as it comes in a print in blocks.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pass {
    layer: usize,
    /// What it has of the layer: all, or what a tool prints.
    of: Option<(ToolId, Laid)>,
    turn: Turn,
}

/// What is laid of what a tool prints.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Laid {
    All,
    /// The prime tower, which each tool is flushed into before it goes down to the first layer of the block.
    Tower,
    Objects,
}

impl Pass {
    fn takes(&self, path: &Path) -> bool {
        self.of.is_none_or(|(tool, laid)| {
            let is_tower = path.role == Role::PrimeTower;
            path.tool == Some(tool) && (laid == Laid::All || (laid == Laid::Tower) == is_tower)
        })
    }

    /// Its paths.
    pub fn paths(&self, layers: &[LayerPaths]) -> LayerPaths {
        let mut paths = layers[self.layer].clone();
        if let Some((tool, _)) = self.of {
            paths.retain(|path| self.takes(path));
            paths.tools = vec![tool];
            paths.turn = self.turn;
        }
        paths
    }
}

/// The parts of the layers of blocks, in the order in which they are printed: of each block those of its first tool, layer by layer,
/// then those of the next, which is flushed into the tower as high as the block is.
pub(crate) fn passes(layers: &[LayerPaths], blocks: &[Block], settings: &Settings) -> Vec<Pass> {
    let motion = MotionSettings::new(settings, &[]);
    let mut passes = Vec::with_capacity(layers.len());
    for block in blocks {
        let top = block.end - 1;
        if block.len() == 1 {
            passes.push(Pass { layer: top, of: None, turn: Turn::default() });
            continue;
        }
        let tools = &layers[top].tools;
        let changes_s: f64 = tools.iter().skip(1).map(|&tool| motion.of_tool(tool).change_time.0).sum();
        let least_s = |of: &dyn Fn(&&Path) -> bool| -> f64 {
            let block = &layers[block.clone()];
            block.iter().map(|layer| least_s(layer.paths.iter().filter(of), layer.index, &motion)).sum()
        };
        for (number, &tool) in tools.iter().enumerate() {
            let is_later = number > 0;
            let others_s = changes_s + least_s(&|path| path.tool != Some(tool));
            let elsewhere = Seconds(others_s / block.len() as f64);
            let pass = |layer: usize, laid: Laid| {
                let is_below = is_later && layer < top;
                let beside_mm = if is_below { layers[top].top_mm } else { 0.0 };
                let turn = Turn { is_later, beside_mm, elsewhere, primes: false };
                Pass { layer, of: Some((tool, laid)), turn }
            };
            let laid = if is_later { Laid::Objects } else { Laid::All };
            let tower = is_later.then(|| pass(top, Laid::Tower));
            let own = tower.into_iter().chain(block.clone().map(|layer| pass(layer, laid)));
            passes.extend(own.filter(|pass| layers[pass.layer].paths.iter().any(|path| pass.takes(path))));
        }
    }
    passes
}
