//! Minimum-cost perfect matching, exact.

mod euclidean;
mod kd_tree;
mod solver;

pub(crate) use euclidean::delaunay;
pub use euclidean::{distance, euclidean};
pub use kd_tree::KdTree;
pub use solver::Edge;
use solver::{Graph, Solver};

/// A perfect matching of minimum total cost, as the partner of each vertex; `None` if there is none.
///
/// Edges are `(end, end, cost)` with costs from 0 to 10^15; parallel edges are allowed, loops are not.
/// O(n·m·log n) at worst, near-linear on nearest-neighbour graphs.
pub fn perfect(vertices: usize, edges: &[Edge]) -> Option<Vec<u32>> {
    let graph = Graph::new(vertices, edges);
    let mut solver = Solver::new(&graph, &graph.cheapest_halves());
    solver.match_greedily();
    solver.run().then(|| solver.finish().mates)
}

#[cfg(test)]
mod tests {
    use super::*;
    use pathwright_geometry::Point;
    use proptest::prelude::*;

    fn cost(edges: &[Edge], mates: &[u32]) -> i64 {
        let cheapest = |u: u32, v: u32| {
            edges
                .iter()
                .filter(|e| (e.0, e.1) == (u, v) || (e.1, e.0) == (u, v))
                .map(|e| e.2)
                .min()
                .expect("an edge")
        };
        (0..mates.len() as u32)
            .filter(|&v| v < mates[v as usize])
            .map(|v| {
                assert_eq!(mates[mates[v as usize] as usize], v);
                cheapest(v, mates[v as usize])
            })
            .sum()
    }

    fn brute_force(vertices: usize, edges: &[Edge]) -> Option<i64> {
        let full = (1_usize << vertices) - 1;
        let mut best = vec![None; full + 1];
        best[0] = Some(0_i64);
        for set in 0..full {
            let Some(so_far) = best[set] else { continue };
            let first = (!set).trailing_zeros();
            for &(u, v, cost) in edges {
                let (u, v) = (u.min(v), u.max(v));
                if u == first && set >> v & 1 == 0 {
                    let next = set | 1 << u | 1 << v;
                    let total = so_far + cost;
                    if best[next].is_none_or(|other| total < other) {
                        best[next] = Some(total);
                    }
                }
            }
        }
        best[full]
    }

    fn graphs(most: usize, top_cost: i64) -> impl Strategy<Value = (usize, Vec<Edge>)> {
        (1..=most / 2).prop_flat_map(move |half| {
            let n = 2 * half as u32;
            let edge = (0..n, 0..n, 0..=top_cost).prop_filter("no loops", |e| e.0 != e.1);
            (Just(2 * half), proptest::collection::vec(edge, 0..(4 * n * n / 5 + 2) as usize))
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(3000))]

        #[test]
        fn agrees_with_brute_force((n, edges) in graphs(10, 1000)) {
            let found = perfect(n, &edges).map(|mates| cost(&edges, &mates));
            prop_assert_eq!(found, brute_force(n, &edges));
        }

        #[test]
        fn agrees_with_brute_force_when_many_costs_are_equal((n, edges) in graphs(12, 3)) {
            let found = perfect(n, &edges).map(|mates| cost(&edges, &mates));
            prop_assert_eq!(found, brute_force(n, &edges));
        }
    }

    /// Layouts that are hard on geometry: random, on a small grid (many ties), on a line, in clusters, all at one point.
    fn layouts() -> impl Strategy<Value = Vec<Point>> {
        let xy = |range: std::ops::Range<i32>| (range.clone(), range);
        let clustered = ((-3..3_i32, -3..3_i32), xy(-20..20))
            .prop_map(|(c, p)| (c.0 * 100_000 + p.0, c.1 * 100_000 + p.1));
        let point = prop_oneof![
            Just(proptest::collection::vec(xy(-1_000_000_000..1_000_000_000).boxed(), 0..30)),
            Just(proptest::collection::vec(xy(0..5).boxed(), 0..40)),
            Just(proptest::collection::vec((-9..9_i32).prop_map(|x| (x, 2 * x)).boxed(), 0..30)),
            Just(proptest::collection::vec(clustered.boxed(), 0..50)),
            Just(proptest::collection::vec(Just((7, 7)).boxed(), 0..9)),
        ];
        point
            .prop_flat_map(|points| points)
            .prop_map(|raw| raw.into_iter().map(|(x, y)| Point::new(x, y)).collect())
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(1500))]

        #[test]
        fn on_points_it_is_as_good_as_on_all_pairs(points in layouts()) {
            let n = points.len() as u32;
            let even = n + n % 2;
            let length = |u: u32, v: u32| if v == n { 0 } else { distance(points[u as usize], points[v as usize]) };
            let edges: Vec<Edge> =
                (0..n).flat_map(|u| (u + 1..even).map(move |v| (u, v))).map(|(u, v)| (u, v, length(u, v))).collect();
            let mut mates = euclidean(&points);
            prop_assert_eq!(mates.len(), points.len());
            if n < even {
                let left: Vec<u32> = (0..n).filter(|&v| mates[v as usize] == v).collect();
                prop_assert_eq!(left.len(), 1);
                mates[left[0] as usize] = n;
                mates.push(left[0]);
            }
            let best = perfect(even as usize, &edges).expect("the graph is complete");
            prop_assert_eq!(cost(&edges, &mates), cost(&edges, &best));
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(300))]

        #[test]
        fn agrees_with_another_implementation((n, edges) in graphs(60, 40)) {
            let mut simple = std::collections::BTreeMap::new();
            for &(u, v, c) in &edges {
                let least = simple.entry((u.min(v), u.max(v))).or_insert(c);
                *least = c.min(*least);
            }
            let weights: Vec<_> = simple.iter().map(|(&(u, v), &c)| (u as usize, v as usize, 2 * (50 - c as i32))).collect();
            let theirs = if weights.is_empty() { vec![] } else { mwmatching::Matching::new(weights).max_cardinality().solve() };
            let perfect_exists = theirs.len() == n && theirs.iter().all(|&mate| mate < n);
            let ours = perfect(n, &edges);
            prop_assert_eq!(ours.is_some(), perfect_exists);
            if let Some(ours) = ours {
                let theirs: Vec<u32> = theirs.iter().map(|&mate| mate as u32).collect();
                prop_assert_eq!(cost(&edges, &ours), cost(&edges, &theirs));
            }
        }
    }
}
