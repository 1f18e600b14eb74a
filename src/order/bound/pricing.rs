//! The cheapest tree over *all* links under given multipliers, by spatial search.

use super::super::christofides::Parts;
use super::super::matching::KdTree;
use super::model::{DEPTHS, Model, fine, link};

/// A set of sibling groups: everything in one parent, to be joined into one.
struct Siblings {
    depth: usize,
    /// Points of the parent, ascending.
    points: Vec<u32>,
    tree: KdTree,
}

/// All links of a layer, ready to be searched.
pub(super) struct Pricing<'a> {
    model: &'a Model,
    /// Deepest first.
    families: Vec<Siblings>,
}

/// A link between two points, with multipliers in its cost.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Priced {
    pub(super) cost: i64,
    pub(super) from: u32,
    pub(super) to: u32,
}

impl<'a> Pricing<'a> {
    pub(super) fn new(model: &'a Model) -> Self {
        let mut order: Vec<u32> = (0..model.points.len() as u32).collect();
        let groups = |point: u32| model.bodies[model.item_of_point(point) as usize].groups;
        order.sort_by_key(|&point| groups(point));
        let mut families = Vec::new();
        for depth in (0..DEPTHS).rev() {
            for parent in order.chunk_by(|&a, &b| groups(a)[..depth] == groups(b)[..depth]) {
                let child = |point: u32| (model.item_of_point(point), groups(point));
                let first = child(parent[0]);
                let parted = |point: &u32| match depth {
                    3 => child(*point).0 != first.0,
                    _ => child(*point).1[depth] != first.1[depth],
                };
                if parent.iter().any(parted) {
                    let places: Vec<_> = parent.iter().map(|&point| model.points[point as usize]).collect();
                    families.push(Siblings { depth, points: parent.to_vec(), tree: KdTree::new(&places) });
                }
            }
        }
        Self { model, families }
    }

    /// Points of each family that has to be joined.
    pub(super) fn families(&self) -> impl Iterator<Item = &[u32]> {
        self.families.iter().map(|family| &family.points[..])
    }

    /// A cheapest tree over the paths: within every group, and over its siblings.
    ///
    /// Borůvka's rounds (1926): each part finds its cheapest way out, among the `listed` links of each depth and, by a search that
    /// leaves out boxes which cannot hold a cheaper one and boxes wholly within the part, among the pairs of paths
    /// that are not `known`, whose links cost their length, a weight at each terminal, and `both`.
    pub(super) fn tree(
        &self,
        weights: &[i64],
        both: &dyn Fn(u32, u32) -> i64,
        listed: &[Vec<Priced>; DEPTHS],
        known: &dyn Fn(u32, u32) -> bool,
    ) -> Vec<Priced> {
        let model = self.model;
        let mut parts = Parts::new(model.bodies.len());
        let mut tree = Vec::new();
        for family in &self.families {
            self.join(family, weights, both, &listed[family.depth], known, &mut parts, &mut tree);
        }
        debug_assert_eq!(tree.len() + 1, model.bodies.len().max(1));
        tree
    }

    #[allow(clippy::too_many_arguments)]
    fn join(
        &self,
        family: &Siblings,
        weights: &[i64],
        both: &dyn Fn(u32, u32) -> i64,
        listed: &[Priced],
        known: &dyn Fn(u32, u32) -> bool,
        parts: &mut Parts,
        tree: &mut Vec<Priced>,
    ) {
        let model = self.model;
        let item = |k: u32| model.item_of_point(family.points[k as usize]);
        let weight = |k: u32| weights[model.owner[family.points[k as usize] as usize] as usize];
        let lowest = family.tree.aggregate(i64::MAX, weight, i64::min);
        let count = family.points.len() as u32;
        let mut inside = vec![false; model.bodies.len()];
        (0..count).for_each(|k| inside[item(k) as usize] = true);
        let listed: Vec<Priced> = listed.iter().copied().filter(|l| inside[model.item_of_point(l.from) as usize] && inside[model.item_of_point(l.to) as usize]).collect();
        loop {
            let part: Vec<u32> = (0..count).map(|k| parts.find(item(k))).collect();
            if part.iter().all(|&p| p == part[0]) {
                return;
            }
            // The part that a whole box lies in, if there is one; u32::MAX if there are several, MAX − 1 if it is empty.
            let common = family.tree.aggregate(u32::MAX - 1, |k| part[k as usize], |a, b| match (a, b) {
                (a, b) if a == b => a,
                (x, y) if x == u32::MAX - 1 => y,
                (x, y) if y == u32::MAX - 1 => x,
                _ => u32::MAX,
            });
            let mut best: Vec<Option<Priced>> = vec![None; model.bodies.len()];
            for &link in &listed {
                let ends = [link.from, link.to].map(|point| parts.find(model.item_of_point(point)));
                if ends[0] != ends[1] {
                    for end in ends {
                        let place = &mut best[end as usize];
                        if place.is_none_or(|best| link < best) {
                            *place = Some(link);
                        }
                    }
                }
            }
            for k in 0..count {
                let at = model.points[family.points[k as usize] as usize];
                let (own_part, own_item, own) = (part[k as usize], item(k), weight(k));
                let mut state = best[own_part as usize];
                let enter = |best: &Option<Priced>, node: usize, distance: f64| {
                    common[node] != own_part
                        && common[node] != u32::MAX - 1
                        && best.is_none_or(|best| fine(distance) - 1 + own + lowest[node] <= best.cost)
                };
                family.tree.search(at, &mut state, &enter, &mut |best, other| {
                    if part[other as usize] == own_part {
                        return;
                    }
                    let (from, to) = (family.points[k as usize], family.points[other as usize]);
                    let mut cost = link(at, model.points[to as usize]) + own + weight(other);
                    if best.is_some_and(|best| cost > best.cost)
                        || !model.permits(own_item, item(other))
                        || known(own_item, item(other))
                    {
                        return;
                    }
                    cost += both(model.owner[from as usize], model.owner[to as usize]);
                    // Equal costs are told apart by the same key at both ends, or parts could close a circle.
                    let found = Priced { cost, from: from.min(to), to: from.max(to) };
                    if best.is_none_or(|best| found < best) {
                        *best = Some(found);
                    }
                });
                best[own_part as usize] = state;
            }
            let before = tree.len();
            for found in best.into_iter().flatten() {
                if parts.join(model.item_of_point(found.from), model.item_of_point(found.to)) {
                    tree.push(found);
                }
            }
            if tree.len() == before {
                return;
            }
        }
    }
}
