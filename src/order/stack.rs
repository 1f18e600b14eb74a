//! Consecutive layers as one ordering problem.

use super::layer::{LayerProblem, PathOrder};
use super::options::Scope;
use super::seam::Pins;
use crate::toolpath::LayerPaths;
use geometry::Point;
use ordering::{Item, Problem, Run, Sequence, Visit};

/// Layers whose paths are those of one problem, in which the stages of each come after those of the one below.
pub struct Stack<'a> {
    /// The problem, from one place to another, where these are known.
    pub problem: Problem<'a>,
    layers: Vec<LayerProblem<'a>>,
}

impl<'a> Stack<'a> {
    /// `pins[i]` belongs to `layers[i]`.
    pub fn new(
        layers: &'a [LayerPaths],
        pins: &'a [Pins],
        scope: Scope,
        (start, end): (Option<Point>, Option<Point>),
    ) -> Self {
        let layers: Vec<_> =
            layers.iter().zip(pins).map(|(layer, pins)| LayerProblem::new(layer, pins, scope)).collect();
        let (mut items, mut runs, mut stages) = (Vec::new(), Vec::new(), 0);
        for (number, LayerProblem { problem, .. }) in (0..).zip(&layers) {
            let first = runs.len() as u32;
            let raised = |run: &Run| Run { stage: run.stage + stages, layer: number, ..*run };
            runs.extend(problem.runs.iter().map(raised));
            stages += problem.runs.iter().map(|run| run.stage + 1).max().unwrap_or(0);
            items.extend(problem.items.iter().map(|item| Item { run: item.run + first, ..*item }));
        }
        Self { problem: Problem { items, runs, scope, start, end }, layers }
    }

    /// Orders of the layers' paths as a solution of the problem.
    pub fn sequence(&self, orders: &[PathOrder]) -> Sequence {
        let mut sequence = Sequence::new();
        for (layer, order) in self.layers.iter().zip(orders) {
            let first = sequence.len() as u32;
            let visits = layer.from_paths(order).into_iter();
            sequence.extend(visits.map(|visit| Visit { item: visit.item + first, ..visit }));
        }
        sequence
    }

    /// A solution of the problem as orders of the layers' paths.
    pub fn orders(&self, sequence: Sequence) -> Vec<PathOrder> {
        let (mut visits, mut first) = (sequence.into_iter(), 0);
        let apart = |layer: &LayerProblem| {
            let own = visits.by_ref().take(layer.problem.items.len());
            let own = own.map(|visit| Visit { item: visit.item - first, ..visit }).collect();
            first += layer.problem.items.len() as u32;
            layer.on_paths(own)
        };
        self.layers.iter().map(apart).collect()
    }
}
