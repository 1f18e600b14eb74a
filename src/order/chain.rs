//! Chains the layers of a print: each begins where the last one ended.
//!
//! Chunks of layers can be solved in parallel without changing the result: their length depends on the number of
//! layers only, each is solved in sequence from a free start, and then the first layer of each is solved again
//! with both of its ends known.

use super::layer::{LayerProblem, ends_on_path, stacked};
use super::precedence::{Frontier, Groups};
use super::seam::{Pins, enter_nearest};
use super::{Cost, Nearest, Problem, Sequence, Shape, Strategy, Visit, strategy};
use crate::geom::Point;
use crate::profile::{OrderSettings, SeamPosition};
use crate::toolpath::LayerPaths;

/// Layers per chunk for a print of so many layers: enough chunks to keep every core busy, and not so
/// short that solving heads twice costs much.
pub fn chunk_len(layers: usize) -> usize {
    (layers / 64).clamp(16, 32)
}

/// How the layers of a print are ordered.
#[derive(Clone, Debug)]
pub struct Chain {
    /// Strategy, scope, effort, whether and how layers are chained.
    pub settings: OrderSettings,
    /// What is minimised.
    pub cost: Cost,
    /// Only `nearest` matters here; the other rules arrive as [`Pins`].
    pub seam: SeamPosition,
    /// Where the nozzle is before the first layer, if that is known.
    pub origin: Option<Point>,
}

impl Chain {
    /// Orders consecutive layers, the first of them from `start` (`None`: from anywhere), each of the others from
    /// where the one before ended. `pins[i]` belongs to `layers[i]`. Entries of loops in the result are
    /// indices into their path's points.
    pub fn solve_chunk(&self, layers: &[LayerPaths], pins: &[Pins], start: Option<Point>) -> Vec<Sequence> {
        // A distance between layers is kept by moving where each begins, which the others must know.
        let apart = self.settings.layer_distance.0 > 0.0;
        if self.settings.chain && !apart && strategy(self.settings.strategy).looks_ahead() {
            return self.solve_together(layers, pins, start);
        }
        let mut at = start;
        let mut sequences = Vec::with_capacity(layers.len());
        for (layer, pins) in layers.iter().zip(pins) {
            let sequence = self.solve_layer(layer, pins, at, None);
            if let Some(&last) = sequence.last() {
                at = Some(ends_on_path(layer, last).1);
            }
            sequences.push(sequence);
        }
        sequences
    }

    /// Orders consecutive layers as one problem, so that each ends where it suits the next.
    fn solve_together(&self, layers: &[LayerPaths], pins: &[Pins], start: Option<Point>) -> Vec<Sequence> {
        let scope = self.settings.scope;
        let mut problems: Vec<_> =
            layers.iter().zip(pins).map(|(layer, pins)| LayerProblem::new(layer, pins, scope)).collect();
        let mut problem = stacked(&problems, scope);
        problem.start = start.or(self.origin);
        let mut at = problem.start;
        let solved = strategy(self.settings.strategy).solve(&problem, &self.cost, self.settings.effort);
        let (mut solved, mut first) = (solved.into_iter(), 0);
        let apart = |(layer, problem): (&LayerPaths, &mut LayerProblem)| {
            let count = layer.paths.len();
            let visits = solved.by_ref().take(count);
            let mut sequence = visits.map(|visit| Visit { item: visit.item - first, ..visit }).collect();
            first += count as u32;
            if self.seam == SeamPosition::Nearest {
                problem.problem.start = at;
                enter_nearest(&problem.problem, &mut sequence);
            }
            let sequence = problem.on_paths(sequence);
            at = sequence.last().map(|&visit| ends_on_path(layer, visit).1).or(at);
            sequence
        };
        layers.iter().zip(&mut problems).map(apart).collect()
    }

    /// Orders the first layer of a chunk again, now that it is known where the chunk before ended (`start`) and
    /// where the layer above begins (`next`, its sequence; `None` if there is none in this chunk).
    /// Returns the better of the old and the new sequence, counting the links at both ends.
    pub fn resolve_head(
        &self,
        head: (&LayerPaths, &Pins),
        solved: Sequence,
        next: Option<(&LayerPaths, &[Visit])>,
        start: Option<Point>,
    ) -> Sequence {
        if !self.settings.chain {
            return solved;
        }
        let (layer, pins) = head;
        let end = next.and_then(|(layer, sequence)| Some(ends_on_path(layer, *sequence.first()?).0));
        let again = self.solve_layer(layer, pins, start, end);
        let cost = |sequence: &[Visit]| self.cost_between(layer, sequence, start, end);
        let too_near = |sequence: &[Visit]| {
            let first = sequence.first().map(|&visit| ends_on_path(layer, visit).0);
            matches!((start, first), (Some(a), Some(b)) if a.distance_mm(b) < self.settings.layer_distance.0)
        };
        let key = |sequence: &[Visit]| (too_near(sequence), cost(sequence));
        if key(&solved) < key(&again) { solved } else { again }
    }

    /// Cost of a layer's links, with those from `start` and to `end` where they are known.
    fn cost_between(
        &self,
        layer: &LayerPaths,
        sequence: &[Visit],
        start: Option<Point>,
        end: Option<Point>,
    ) -> f64 {
        let (mut at, mut island, mut total) = (start, None, 0.0);
        for &visit in sequence {
            let (enter, leave) = ends_on_path(layer, visit);
            let here = Some(layer.paths[visit.item as usize].island);
            total += at.map_or(0.0, |from| self.cost.of(from.distance_mm(enter), here == island));
            (at, island) = (Some(leave), here);
        }
        total + at.zip(end).map_or(0.0, |(from, to)| self.cost.of(from.distance_mm(to), false))
    }

    fn solve_layer(
        &self,
        layer: &LayerPaths,
        pins: &Pins,
        start: Option<Point>,
        end: Option<Point>,
    ) -> Sequence {
        let mut layer = LayerProblem::new(layer, pins, self.settings.scope);
        (layer.problem.start, layer.problem.end) =
            if self.settings.chain { (start.or(self.origin), end) } else { (self.origin, None) };
        let mut sequence = self.solve_apart(&mut layer.problem, start);
        if self.seam == SeamPosition::Nearest {
            enter_nearest(&layer.problem, &mut sequence);
        }
        layer.on_paths(sequence)
    }

    /// Solves a problem; if its walk would begin too near to where the last layer ended, it is made to begin at
    /// the nearest entry that is far enough, where there is one.
    fn solve_apart(&self, problem: &mut Problem, last: Option<Point>) -> Sequence {
        let solve = |problem: &Problem| {
            strategy(self.settings.strategy).solve(problem, &self.cost, self.settings.effort)
        };
        let sequence = solve(problem);
        let distance_mm = self.settings.layer_distance.0;
        let Some(last) = last.filter(|_| distance_mm > 0.0) else { return sequence };
        let begins_apart = |problem: &Problem, sequence: &Sequence| {
            sequence.first().is_none_or(|first| {
                problem.items[first.item as usize].ends(first.entry).0.distance_mm(last) >= distance_mm
            })
        };
        if begins_apart(problem, &sequence) {
            return sequence;
        }
        let Some(begin) = nearest_apart(problem, last, distance_mm) else { return sequence };
        let start = problem.start.replace(begin);
        let apart = Some(solve(problem))
            .filter(|sequence| begins_apart(problem, sequence))
            .unwrap_or_else(|| Nearest.solve(problem, &self.cost, self.settings.effort));
        problem.start = start;
        if begins_apart(problem, &apart) { apart } else { sequence }
    }
}

/// The entry nearest to `last` that is at least so far away, among the items that may come first.
fn nearest_apart(problem: &Problem, last: Point, distance_mm: f64) -> Option<Point> {
    let groups = Groups::new(problem);
    let (_, available) = Frontier::new(&groups);
    let items = available.iter().flat_map(|&group| &groups.items[group as usize]);
    let points = items.flat_map(|&item| match &problem.items[item as usize].shape {
        Shape::Open(ends) => ends.as_slice(),
        Shape::Loop(vertices) => vertices,
    });
    points.copied().filter(|p| p.distance_mm(last) >= distance_mm).min_by_key(|p| (p.distance2(last), *p))
}
