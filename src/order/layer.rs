//! From the paths of a layer to an ordering problem and back.

use rustc_hash::FxHashMap;

use super::options::Scope;
use super::seam::Pins;
use crate::toolpath::{LayerPaths, Path, Role};
use geometry::Point;
use ordering::{Item, Problem, Run, Sequence, Shape, Visit};

/// The problem of one layer whose seams are free or pinned.
#[derive(Clone, Debug)]
pub struct LayerProblem<'a> {
    /// The problem: item i is path i of the layer. A pinned loop has one entry.
    pub problem: Problem<'a>,
    pins: &'a Pins,
}

impl<'a> LayerProblem<'a> {
    /// The problem of a layer; start and end are unknown. Runs are numbered as they first appear.
    pub fn new(layer: &'a LayerPaths, pins: &'a Pins, scope: Scope) -> Self {
        let mut numbers = FxHashMap::default();
        let mut runs = Vec::new();
        let mut items = Vec::with_capacity(layer.paths.len());
        for (index, path) in layer.paths.iter().enumerate() {
            let run = Run { stage: stage(path.role), island: path.island, rank: path.rank };
            let number = *numbers.entry((run.stage, run.island, run.rank)).or_insert_with(|| {
                runs.push(run);
                runs.len() as u32 - 1
            });
            let pin = pins.as_ref().map(|pins| pins[index] as usize);
            items.push(Item { run: number, shape: shape(path, pin) });
        }
        Self { problem: Problem { items, runs, scope, start: None, end: None }, pins }
    }

    /// A solution of the problem in terms of the layer: the entry of a loop is an index into its path's points.
    pub fn on_paths(&self, mut sequence: Sequence) -> Sequence {
        if let Some(pins) = self.pins {
            self.loops(&mut sequence).for_each(|visit| visit.entry += pins[visit.item as usize]);
        }
        sequence
    }

    /// A solution in terms of the layer as one of the problem: what [`Self::on_paths`] makes of it is the same again.
    pub fn from_paths(&self, mut sequence: Sequence) -> Sequence {
        if let Some(pins) = self.pins {
            self.loops(&mut sequence).for_each(|visit| visit.entry -= pins[visit.item as usize]);
        }
        sequence
    }

    fn loops<'s>(&self, sequence: &'s mut Sequence) -> impl Iterator<Item = &'s mut Visit> {
        let is_loop =
            |visit: &&mut Visit| matches!(self.problem.items[visit.item as usize].shape, Shape::Loop(_));
        sequence.iter_mut().filter(is_loop)
    }
}

/// Stages of one layer.
const STAGES: u32 = 2;

/// Consecutive layers as one problem, in which the stages of each come after those of the one below. Start and end are unknown.
pub fn stacked<'a>(layers: &[LayerProblem<'a>], scope: Scope) -> Problem<'a> {
    let (mut items, mut runs) = (Vec::new(), Vec::new());
    for (number, LayerProblem { problem, .. }) in (0..).zip(layers) {
        let first = runs.len() as u32;
        runs.extend(problem.runs.iter().map(|run| Run { stage: run.stage + STAGES * number, ..*run }));
        items.extend(problem.items.iter().map(|item| Item { run: item.run + first, ..*item }));
    }
    Problem { items, runs, scope, start: None, end: None }
}

/// Skirt, brim and support come before everything else.
fn stage(role: Role) -> u32 {
    u32::from(!matches!(role, Role::Skirt | Role::Brim | Role::Support | Role::SupportInterface))
}

fn shape(path: &Path, pin: Option<usize>) -> Shape<'_> {
    let points = &path.points;
    match (path.closed, pin) {
        (true, Some(pin)) => Shape::Loop(&points[pin..=pin]),
        (true, None) => Shape::Loop(points),
        (false, _) => Shape::Open([points[0], points[points.len() - 1]]),
    }
}

/// Where drawing a path begins and where it ends, for a visit as [`LayerProblem::on_paths`] gives it.
pub fn ends_on_path(layer: &LayerPaths, visit: Visit) -> (Point, Point) {
    let path = &layer.paths[visit.item as usize];
    Item { run: 0, shape: shape(path, None) }.ends(visit.entry)
}
