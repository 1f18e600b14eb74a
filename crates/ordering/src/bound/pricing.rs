//! The cheapest tree over *all* links under given multipliers, by spatial search.

use super::super::matching::KdTree;
use super::model::{DEPTHS, Model, least_price};
use pathwright_geometry::DisjointSets;

/// A set of sibling groups: everything in one parent, to be joined into one.
struct Siblings {
    depth: usize,
    /// Points of the parent, ascending.
    points: Vec<u32>,
    tree: KdTree,
}

/// All links of a layer, prepared to be searched.
pub(super) struct Pricing<'a> {
    model: &'a Model,
    /// Deepest first.
    families: Vec<Siblings>,
}

/// The prices of links under the multipliers.
pub(super) struct Prices<'a> {
    /// The known links, by depth.
    pub(super) listed: [Vec<Priced>; DEPTHS],
    /// Whether the link of two terminals is listed.
    pub(super) known: &'a dyn Fn(u32, u32) -> bool,
    /// All other links cost what they do by themselves, this at each terminal,
    pub(super) weights: &'a [i64],
    /// and this, never negative, for what the two terminals share.
    pub(super) both: &'a dyn Fn(u32, u32) -> i64,
}

/// A link between two points (of listed ones: the first of either terminal), with multipliers in its cost.
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
                    let points: Vec<_> = parent.iter().map(|&point| model.points[point as usize]).collect();
                    families.push(Siblings { depth, points: parent.to_vec(), tree: KdTree::new(&points) });
                }
            }
        }
        Self { model, families }
    }

    /// Points of each family that has to be joined.
    pub(super) fn families(&self) -> impl Iterator<Item = &[u32]> {
        self.families.iter().map(|family| &family.points[..])
    }

    /// A cheapest tree over the paths: within every group, and over its siblings, down from groups at some depth.
    ///
    /// Borůvka's rounds (1926, translated in Nešetřil, Milková & Nešetřilová 2001, <https://doi.org/10.1016/S0012-365X(00)00224-7>): each part finds its cheapest link outwards, among the listed links and by a
    /// search that leaves out boxes which cannot hold a cheaper one and boxes that lie wholly within the part.
    pub(super) fn tree(&self, prices: &Prices, depth: usize) -> Vec<Priced> {
        let mut parts = DisjointSets::new(self.model.bodies.len());
        let mut tree = Vec::new();
        for family in self.families.iter().filter(|family| family.depth >= depth) {
            self.join(family, prices, &mut parts, &mut tree);
        }
        tree
    }

    fn items(&self, link: Priced) -> [u32; 2] {
        [link.from, link.to].map(|point| self.model.item_of_point(point))
    }

    fn join(&self, family: &Siblings, prices: &Prices, parts: &mut DisjointSets, tree: &mut Vec<Priced>) {
        let model = self.model;
        let owner = |k: usize| model.owner[family.points[k] as usize];
        let items: Vec<u32> = family.points.iter().map(|&point| model.item_of_point(point)).collect();
        let lowest =
            family.tree.aggregate(i64::MAX, |k| prices.weights[owner(k as usize) as usize], i64::min);
        let mut here = vec![false; model.bodies.len()];
        items.iter().for_each(|&item| here[item as usize] = true);
        let listed = prices.listed[family.depth].iter().copied();
        let listed: Vec<Priced> =
            listed.filter(|&link| self.items(link).iter().all(|&i| here[i as usize])).collect();
        loop {
            let part: Vec<u32> = items.iter().map(|&item| parts.find(item)).collect();
            if part.iter().all(|&p| p == part[0]) {
                return;
            }
            let common =
                family.tree.aggregate(Common::Empty, |k| Common::One(part[k as usize]), Common::with);
            let mut best: Vec<Option<Priced>> = vec![None; model.bodies.len()];
            for &link in &listed {
                let ends = self.items(link).map(|item| parts.find(item));
                for end in ends.into_iter().filter(|_| ends[0] != ends[1]) {
                    improve(&mut best[end as usize], link);
                }
            }
            for (k, &from) in family.points.iter().enumerate() {
                let (at, own_part, terminal) = (model.points[from as usize], part[k], owner(k));
                let own = prices.weights[terminal as usize];
                let enter = |best: &Option<Priced>, node: usize, distance: f64| {
                    common[node] != Common::One(own_part)
                        && common[node] != Common::Empty
                        && best.is_none_or(|best| {
                            least_price(&model.cost, distance) + own + lowest[node] <= best.cost
                        })
                };
                family.tree.search(at, &mut best[own_part as usize], &enter, &mut |best, other| {
                    let other = other as usize;
                    let (to, far) = (family.points[other], owner(other));
                    if part[other] == own_part {
                        return;
                    }
                    let cost = model.price(from, to) + own + prices.weights[far as usize];
                    if best.is_none_or(|best| cost <= best.cost)
                        && model.permits(items[k], items[other])
                        && !(prices.known)(terminal, far)
                    {
                        let cost = cost + (prices.both)(terminal, far);
                        improve(best, Priced { cost, from: from.min(to), to: from.max(to) });
                    }
                });
            }
            let before = tree.len();
            for found in best.into_iter().flatten() {
                let [i, j] = self.items(found);
                if parts.join(i, j) {
                    tree.push(found);
                }
            }
            if tree.len() == before {
                return;
            }
        }
    }
}

/// Ties between equal costs are broken by the points, identically from both ends; otherwise parts could close a cycle.
fn improve(best: &mut Option<Priced>, link: Priced) {
    if best.is_none_or(|best| link < best) {
        *best = Some(link);
    }
}

/// The part that all points of a box lie in, if there is one.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Common {
    Empty,
    One(u32),
    Several,
}

impl Common {
    fn with(self, other: Self) -> Self {
        match (self, other) {
            (one, Self::Empty) | (Self::Empty, one) => one,
            (one, other) if one == other => one,
            _ => Self::Several,
        }
    }
}
