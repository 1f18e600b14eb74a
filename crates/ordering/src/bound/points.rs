//! Points with prices, for links that lead there.

use super::model::{fine, link};
use crate::matching::KdTree;
use pathwright_geometry::Point;

/// Points with a price each.
pub(super) struct PricedPoints {
    priced: Vec<(Point, i64)>,
    tree: KdTree,
    lowest: Vec<i64>,
}

impl PricedPoints {
    pub(super) fn new(priced: Vec<(Point, i64)>) -> Self {
        let points: Vec<Point> = priced.iter().map(|&(p, _)| p).collect();
        let tree = KdTree::new(&points);
        let lowest = tree.aggregate(i64::MAX, |id| priced[id as usize].1, i64::min);
        Self { priced, tree, lowest }
    }

    /// The least sum of a link and the price at its other end.
    pub(super) fn nearest(&self, from: Point) -> i64 {
        let mut best = i64::MAX;
        let enter = |best: &i64, node: usize, distance: f64| {
            (fine(distance) - 1).saturating_add(self.lowest[node]) < *best
        };
        self.tree.search(from, &mut best, &enter, &mut |best, id| {
            let (point, price) = self.priced[id as usize];
            *best = (*best).min(link(from, point) + price);
        });
        best
    }
}
