//! From the paths of a layer to an ordering problem and back.

use rustc_hash::FxHashMap;

use super::options::Scope;
use super::seam::Pins;
use crate::toolpath::{LayerPaths, Path, Phase, Role};
use geometry::Point;
use ordering::{Item, Problem, Run, Sequence, Shape, Visit};

/// The problem of one layer whose seams are free, painted or pinned.
#[derive(Clone, Debug)]
pub struct LayerProblem<'a> {
    /// The problem: item i is path i of the layer. A pinned loop has one entry, a painted one those where it may begin.
    pub problem: Problem<'a>,
    layer: &'a LayerPaths,
    pins: &'a Pins,
}

impl<'a> LayerProblem<'a> {
    /// The problem of a layer; start and end are unknown. Runs are numbered as they first appear.
    pub fn new(layer: &'a LayerPaths, pins: &'a Pins, scope: Scope) -> Self {
        let mut numbers = FxHashMap::default();
        let mut runs = Vec::new();
        let mut items = Vec::with_capacity(layer.paths.len());
        for (index, path) in layer.paths.iter().enumerate() {
            let island = path.island.map_or(NO_ISLAND, |island| island.0);
            let run = Run { stage: stage(path, layer), island, layer: 0, rank: rank(path.phase) };
            let number = *numbers.entry((run.stage, run.island, run.rank)).or_insert_with(|| {
                runs.push(run);
                runs.len() as u32 - 1
            });
            let pin = pins.as_ref().map(|pins| pins[index] as usize);
            let painted = layer.entries.get(&(index as u32)).filter(|_| pin.is_none());
            let shape = painted.map_or_else(|| shape(path, pin), |entries| Shape::Loop(&entries.points));
            items.push(Item { run: number, shape });
        }
        Self { problem: Problem { items, runs, scope, start: None, end: None }, layer, pins }
    }

    /// A solution of the problem as an order of the layer's paths.
    pub fn on_paths(&self, sequence: Sequence) -> PathOrder {
        let visit = |Visit { item, entry }| PathVisit { path: item, entry: self.on_path(item, entry) };
        sequence.into_iter().map(visit).collect()
    }

    /// Turns an order of the layer's paths into a solution of the problem: what [`Self::on_paths`] makes of it is the
    /// same again.
    pub fn from_paths(&self, order: &[PathVisit]) -> Sequence {
        let visit =
            |&PathVisit { path, entry }: &PathVisit| Visit { item: path, entry: self.of_path(path, entry) };
        order.iter().map(visit).collect()
    }

    /// The vertex that an entry of an item is; open paths have none.
    fn on_path(&self, item: u32, entry: u32) -> u32 {
        match (self.problem.items[item as usize].shape, self.pins, self.layer.entries.get(&item)) {
            (Shape::Open(_), ..) => entry,
            (_, Some(pins), _) => pins[item as usize],
            (_, None, Some(entries)) => entries.vertices[entry as usize],
            (_, None, None) => entry,
        }
    }

    /// The entry that a vertex of a path is.
    fn of_path(&self, path: u32, vertex: u32) -> u32 {
        match (self.problem.items[path as usize].shape, self.pins, self.layer.entries.get(&path)) {
            (Shape::Open(_), ..) => vertex,
            (_, Some(_), _) => 0,
            (_, None, Some(entries)) => entries.vertices.partition_point(|&other| other < vertex) as u32,
            (_, None, None) => vertex,
        }
    }
}

/// One step of a layer's order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PathVisit {
    /// Index of the path in its layer.
    pub path: u32,
    /// Open paths: 0 forwards, 1 backwards. Loops: index into the path's points.
    pub entry: u32,
}

/// The order of a layer: every path once.
pub type PathOrder = Vec<PathVisit>;

/// What belongs to no island.
const NO_ISLAND: u32 = u32::MAX;

/// Phases as ranks.
fn rank(phase: Phase) -> u32 {
    match phase {
        Phase::Tower(number) => number,
        Phase::Skirt => 0,
        Phase::Brim => 1,
        Phase::Support => 2,
        Phase::SupportInterface => 3,
        Phase::Wall(depth) => depth,
        Phase::Inside => 1000,
        Phase::Top(line) => 2000 + line,
        Phase::Ironing => u32::MAX,
        Phase::Found(rank) => rank,
    }
}

/// Skirt, brim and support come before everything else. Where a printer has several tools, what one of them prints comes
/// after what those before it do, and before all the prime tower.
fn stage(path: &Path, layer: &LayerPaths) -> u32 {
    let part =
        u32::from(!matches!(path.role, Role::Skirt | Role::Brim | Role::Support | Role::SupportInterface));
    if layer.tools.is_empty() {
        return part;
    }
    let turn = layer.tools.iter().position(|tool| path.tool.is_none_or(|own| own == *tool));
    let part = match (path.role, path.phase) {
        (Role::PrimeTower, _) => 0,
        // The ooze shield, then what a tool is flushed into.
        (Role::Skirt, Phase::Tower(_)) => 1,
        (_, Phase::Tower(_)) => 2,
        _ => 3 + part,
    };
    5 * turn.unwrap_or(0) as u32 + part
}

fn shape(path: &Path, pin: Option<usize>) -> Shape<'_> {
    let points = &path.points;
    match (path.closed, pin) {
        (true, Some(pin)) => Shape::Loop(&points[pin..=pin]),
        (true, None) => Shape::Loop(points),
        (false, _) => Shape::Open([points[0], points[points.len() - 1]]),
    }
}

/// Where drawing a path begins and where it ends.
pub fn ends_on_path(layer: &LayerPaths, visit: PathVisit) -> (Point, Point) {
    let path = &layer.paths[visit.path as usize];
    Item { run: 0, shape: shape(path, None) }.ends(visit.entry)
}
