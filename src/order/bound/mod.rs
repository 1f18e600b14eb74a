//! Lower bounds on what any order of a layer, or of a print, must travel.
//!
//! A walk through all paths is a tree of links: within every group that precedence keeps together, and over the groups.
//! The cheapest such tree is a lower bound, and remains one when links pay multipliers, as long as what every walk
//! would pay is given back: one link at each end of an open path, two at a loop, an odd number out of certain sets. The
//! ascent looks for multipliers under which the tree resembles a walk; whatever it finds, the bound is evaluated over
//! *all* links, in integers, each link rounded down. `docs/ordering-bounds.md` has the proof and the figures.

mod ascent;
mod cuts;
mod model;
mod pricing;
mod relaxation;
mod tree;

use super::Problem;
use super::matching::KdTree;
use crate::geom::Point;
use ascent::ascend;
use model::{Model, fine, link, to_mm};
use relaxation::Relaxation;

/// A length in millimetres that the links of no solution of the problem can stay below.
pub fn layer(problem: &Problem) -> f64 {
    let model = Model::new(problem);
    if model.bodies.is_empty() {
        return 0.0;
    }
    let mut relaxation = Relaxation::new(&model);
    if let Some(start) = problem.start {
        relaxation.arrive(|p| link(start, p));
    }
    if let Some(end) = problem.end {
        relaxation.leave(|p| link(p, end));
    }
    to_mm(ascend(&mut relaxation).0.max(0))
}

/// A length in millimetres that the links of a whole print cannot stay below, however its layers are ordered and wherever
/// they begin and end. The start of the first layer and the end of the last count where they are known, all others
/// are ignored; layers without paths are passed over.
pub fn print<'a>(layers: impl IntoIterator<Item = Problem<'a>>) -> f64 {
    let mut layers = layers.into_iter().filter(|layer| !layer.items.is_empty()).peekable();
    let mut places = layers.peek().and_then(|first| first.start).map(|start| Places::new(vec![(start, 0)]));
    let mut total = 0;
    while let Some(problem) = layers.next() {
        let model = Model::new(&problem);
        let mut relaxation = Relaxation::new(&model);
        if let Some(places) = &places {
            relaxation.arrive(|p| places.nearest(p));
        }
        match layers.peek() {
            Some(next) => {
                let next = Model::new(next);
                let places = Places::new(next.beginnings().map(|p| (p, 0)).collect());
                relaxation.leave(|p| places.nearest(p));
            }
            None => {
                if let Some(end) = problem.end {
                    relaxation.leave(|p| link(p, end));
                }
            }
        }
        let (bound, multipliers) = ascend(&mut relaxation);
        if layers.peek().is_none() {
            return to_mm((total + bound).max(0));
        }
        let (settled, ends) = relaxation.settle(&multipliers);
        total += settled;
        places = Some(Places::new(ends));
    }
    to_mm(total.max(0))
}

/// Places with a price each.
struct Places {
    places: Vec<(Point, i64)>,
    tree: KdTree,
    lowest: Vec<i64>,
}

impl Places {
    fn new(places: Vec<(Point, i64)>) -> Self {
        let points: Vec<Point> = places.iter().map(|&(p, _)| p).collect();
        let tree = KdTree::new(&points);
        let lowest = tree.aggregate(i64::MAX, |id| places[id as usize].1, i64::min);
        Self { places, tree, lowest }
    }

    /// The least sum of a link and the price at its other end.
    fn nearest(&self, from: Point) -> i64 {
        let mut best = i64::MAX;
        let enter = |best: &i64, node: usize, distance: f64| {
            (fine(distance) - 1).saturating_add(self.lowest[node]) < *best
        };
        self.tree.search(from, &mut best, &enter, &mut |best, id| {
            let (place, price) = self.places[id as usize];
            *best = (*best).min(link(from, place) + price);
        });
        best
    }
}
