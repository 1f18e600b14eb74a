//! Points with prices, for links that lead there.

use super::model::{least_price, price};
use crate::cost::LinkCosts;
use crate::matching::KdTree;
use crate::{Cost, LinkKind};
use pathwright_geometry::Point;

/// Points of another layer, with a price each.
pub(super) struct PricedPoints {
    /// What links there cost.
    cost: LinkCosts,
    priced: Vec<(Point, i64)>,
    tree: KdTree,
    lowest: Vec<i64>,
}

impl PricedPoints {
    pub(super) fn new(priced: Vec<(Point, i64)>, cost: &Cost) -> Self {
        let points: Vec<Point> = priced.iter().map(|&(p, _)| p).collect();
        let tree = KdTree::new(&points);
        let lowest = tree.aggregate(i64::MAX, |id| priced[id as usize].1, i64::min);
        Self { cost: LinkCosts::from(*cost), priced, tree, lowest }
    }

    /// The least sum of a link and the price at its other end.
    pub(super) fn nearest(&self, from: Point) -> i64 {
        let mut best = i64::MAX;
        let enter = |best: &i64, node: usize, distance: f64| {
            least_price(&self.cost, distance).saturating_add(self.lowest[node]) < *best
        };
        self.tree.search(from, &mut best, &enter, &mut |best, id| {
            let (point, own) = self.priced[id as usize];
            *best = (*best).min(price(&self.cost, from, point, LinkKind::UP) + own);
        });
        best
    }
}
