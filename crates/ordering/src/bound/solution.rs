//! What the links of a solution cost, in fine units.

use super::model::price;
use crate::cost::LinkCosts;
use crate::{Cost, LinkKind, Problem, Visit};
use pathwright_geometry::Point;

/// Half the cost of the links at each path in a solution, in fine units.
pub(super) fn half_links(problem: &Problem, order: &[Visit], cost: &Cost) -> Vec<i64> {
    let mut halves = vec![0; problem.items.len()];
    for (visits, link) in order.windows(2).zip(prices(problem, order, cost)) {
        visits.iter().for_each(|visit| halves[visit.item as usize] += link / 2);
    }
    halves
}

/// Cost of the links between the paths of a solution, in fine units, each rounded down.
pub(super) fn prices(problem: &Problem, order: &[Visit], cost: &Cost) -> impl Iterator<Item = i64> {
    let costs = LinkCosts::from(*cost);
    order.windows(2).map(move |visits| {
        let [a, b] = [0, 1].map(|k| &problem.items[visits[k].item as usize]);
        let [from, to] = [a, b].map(|item| &problem.runs[item.run as usize]);
        let kind = LinkKind::between(from, to);
        price(&costs, a.ends(visits[0].entry).1, b.ends(visits[1].entry).0, kind)
    })
}

/// Cost of the links into a solution and out of it, as `beyond` says for the side and a point.
pub(super) fn outer(problem: &Problem, order: &[Visit], beyond: impl Fn(usize, Point) -> i64) -> i64 {
    let ends = |visit: &Visit| problem.items[visit.item as usize].ends(visit.entry);
    let enter = order.first().map_or(0, |visit| beyond(0, ends(visit).0));
    enter + order.last().map_or(0, |visit| beyond(1, ends(visit).1))
}
