//! A static k-d tree over points, whose nodes can carry values for pruning searches.
//!
//! Bentley 1975, <https://doi.org/10.1145/361002.361007>: halves at the median of the longer side. Searches that weigh
//! points (additively weighted nearest neighbours, pairs with negative reduced cost) attach the extreme weight of
//! each node by [`KdTree::aggregate`] and decide themselves which nodes to leave out.

use pathwright_geometry::{Bounds, Point};

/// Points in a leaf, at most.
const LEAF: usize = 8;

/// Distance of a point from a box, in units, rounded.
fn distance(bounds: &Bounds, p: Point) -> f64 {
    let [dx, dy] = bounds.beyond(p).map(|d| d as f64);
    (dx * dx + dy * dy).sqrt()
}

/// The tree. Node 0 is the root, node `i` has the children `2i + 1` and `2i + 2`.
pub struct KdTree {
    /// Point indices, each node a contiguous piece.
    order: Vec<u32>,
    boxes: Vec<Bounds>,
}

impl KdTree {
    /// A tree over points. O(n log n).
    pub fn new(points: &[Point]) -> Self {
        let mut nodes = 1;
        let mut size = points.len();
        while size > LEAF {
            nodes = 2 * nodes + 1;
            size -= size / 2;
        }
        let nowhere = Bounds { min: Point::new(i32::MAX, i32::MAX), max: Point::new(i32::MIN, i32::MIN) };
        let mut tree = Self { order: (0..points.len() as u32).collect(), boxes: vec![nowhere; nodes] };
        tree.split(points, 0, 0, points.len());
        tree
    }

    fn split(&mut self, points: &[Point], node: usize, from: usize, to: usize) {
        let ids = &mut self.order[from..to];
        let bounds = Bounds::of(ids.iter().map(|&id| points[id as usize])).unwrap_or(self.boxes[node]);
        self.boxes[node] = bounds;
        if 2 * node + 1 >= self.boxes.len() {
            return;
        }
        let half = ids.len() / 2;
        let [width, height] = bounds.size();
        let wide = width >= height;
        let key = |id: &u32| {
            let p = points[*id as usize];
            if wide { (p.x, p.y, *id) } else { (p.y, p.x, *id) }
        };
        if half < ids.len() {
            ids.select_nth_unstable_by_key(half, key);
        }
        self.split(points, 2 * node + 1, from, from + half);
        self.split(points, 2 * node + 2, from + half, to);
    }

    /// The nearest of the points that the tree is over, by squared distance in square units and index.
    pub fn nearest(&self, points: &[Point], from: Point) -> Option<(i64, u32)> {
        let mut best = None::<(i64, u32)>;
        // Boxes are measured with rounding; one unit more than makes up for it.
        let enter = |best: &Option<(i64, u32)>, _, distance: f64| {
            best.is_none_or(|(distance2, _)| distance <= (distance2 as f64).sqrt() + 1.0)
        };
        let mut visit = |best: &mut Option<(i64, u32)>, id: u32| {
            let found = (points[id as usize].distance2(from), id);
            *best = Some(best.map_or(found, |best| best.min(found)));
        };
        self.search(from, &mut best, &enter, &mut visit);
        best
    }

    fn is_leaf(&self, node: usize) -> bool {
        2 * node + 1 >= self.boxes.len()
    }

    /// One value for each node: `combine` of the values of the points in it, `empty` where there is none.
    pub(crate) fn aggregate<T: Copy>(
        &self,
        empty: T,
        value: impl Fn(u32) -> T,
        combine: impl Fn(T, T) -> T,
    ) -> Vec<T> {
        let mut values = vec![empty; self.boxes.len()];
        self.aggregate_into(&mut values, 0, (0, self.order.len()), &value, &combine);
        values
    }

    fn aggregate_into<T: Copy>(
        &self,
        values: &mut [T],
        node: usize,
        (from, to): (usize, usize),
        value: &impl Fn(u32) -> T,
        combine: &impl Fn(T, T) -> T,
    ) {
        if self.is_leaf(node) {
            values[node] = self.order[from..to].iter().fold(values[node], |sum, &id| combine(sum, value(id)));
            return;
        }
        let half = from + (to - from) / 2;
        self.aggregate_into(values, 2 * node + 1, (from, half), value, combine);
        self.aggregate_into(values, 2 * node + 2, (half, to), value, combine);
        values[node] = combine(values[2 * node + 1], values[2 * node + 2]);
    }

    /// Calls `visit` for every point of every leaf that `enter(node, distance in grid units from `from` to its box)` lets it
    /// into, nearer children first. `state` is handed to both, so that a search can narrow as it goes.
    pub(crate) fn search<S>(
        &self,
        from: Point,
        state: &mut S,
        enter: &impl Fn(&S, usize, f64) -> bool,
        visit: &mut impl FnMut(&mut S, u32),
    ) {
        let distance = distance(&self.boxes[0], from);
        if !self.order.is_empty() && enter(state, 0, distance) {
            self.descend(0, (0, self.order.len()), from, state, enter, visit);
        }
    }

    fn descend<S>(
        &self,
        node: usize,
        (first, last): (usize, usize),
        from: Point,
        state: &mut S,
        enter: &impl Fn(&S, usize, f64) -> bool,
        visit: &mut impl FnMut(&mut S, u32),
    ) {
        if self.is_leaf(node) {
            for &id in &self.order[first..last] {
                visit(state, id);
            }
            return;
        }
        let half = first + (last - first) / 2;
        let mut children = [(2 * node + 1, (first, half)), (2 * node + 2, (half, last))]
            .map(|(child, piece)| (distance(&self.boxes[child], from), child, piece));
        if children[1].0 < children[0].0 {
            children.swap(0, 1);
        }
        for (distance, child, piece) in children {
            if enter(state, child, distance) {
                self.descend(child, piece, from, state, enter, visit);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn finds_the_nearest_by_distance_plus_weight(
            raw in proptest::collection::vec((-50..50_i32, -50..50_i32, 0..40_u32), 1..80),
            (x, y) in (-60..60_i32, -60..60_i32),
        ) {
            let points: Vec<_> = raw.iter().map(|r| Point::new(r.0, r.1)).collect();
            let from = Point::new(x, y);
            let tree = KdTree::new(&points);
            let least = tree.aggregate(f64::INFINITY, |id| f64::from(raw[id as usize].2), f64::min);
            let total = |id: u32| (points[id as usize].distance2(from) as f64).sqrt() + f64::from(raw[id as usize].2);
            let mut best = f64::INFINITY;
            tree.search(from, &mut best, &|best, node, d| d + least[node] < *best, &mut |best, id| *best = best.min(total(id)));
            let expected = (0..points.len() as u32).map(total).fold(f64::INFINITY, f64::min);
            prop_assert_eq!(best, expected);
        }
    }
}
