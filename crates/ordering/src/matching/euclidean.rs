//! Minimum-cost perfect matching of points in the plane: sparse candidates first, then proof against all pairs.

use rustc_hash::FxHashSet;
use spade::{DelaunayTriangulation, Point2, Triangulation};

use super::kd_tree::KdTree;
use super::solver::{Edge, Family, Graph, NONE, Solver};
use pathwright_geometry::Point;

/// Neighbours by distance that join the Delaunay edges as first candidates. On 10,000 random points pricing then adds
/// 136 pairs in three rounds; with ten neighbours 16, also in three, on a graph half as large again.
const NEAREST: usize = 5;

/// Distance in grid units, rounded up: the triangle inequality survives that rounding, which coincident points
/// below and the shortcuts of Christofides rely on.
pub fn distance(a: Point, b: Point) -> i64 {
    let squared = a.distance2(b);
    let mut root = (squared as f64).sqrt() as i64;
    while root * root < squared {
        root += 1;
    }
    while root > 0 && (root - 1) * (root - 1) >= squared {
        root -= 1;
    }
    root
}

/// Delaunay edges of distinct points, by index; they hold a Euclidean minimum spanning tree (Shamos & Hoey 1975,
/// <https://doi.org/10.1109/SFCS.1975.8>). Of coincident points only one takes part.
pub(crate) fn delaunay(points: &[Point]) -> Vec<(u32, u32)> {
    let sites = points.iter().map(|p| Point2::new(f64::from(p.x), f64::from(p.y))).collect();
    let mut edges = Vec::new();
    if let Ok(triangulation) = DelaunayTriangulation::<Point2<f64>>::bulk_load_stable(sites) {
        // Coincident sites are merged, which shifts the indices after them.
        let index = site_indices(points, &triangulation);
        for edge in triangulation.undirected_edges() {
            let [u, v] = edge.vertices().map(|vertex| index[vertex.index()]);
            edges.push((u.min(v), u.max(v)));
        }
    }
    edges
}

fn site_indices(points: &[Point], triangulation: &DelaunayTriangulation<Point2<f64>>) -> Vec<u32> {
    if triangulation.num_vertices() == points.len() {
        return (0..points.len() as u32).collect();
    }
    let mut by_place: Vec<(Point, u32)> = points.iter().copied().zip(0..).collect();
    by_place.sort_unstable();
    triangulation
        .vertices()
        .map(|vertex| {
            let at = vertex.position();
            let at = Point::new(at.x as i32, at.y as i32);
            by_place[by_place.partition_point(|&(p, _)| p < at)].1
        })
        .collect()
}

/// Pairs the points so that the total of [`distance`] is least, exactly: `result[v]` is the partner of `v`. Of an odd
/// number, one point is left over, whichever makes the rest cheapest; it is its own partner.
///
/// Coincident points are paired with each other first, which the triangle inequality allows. The rest is solved on
/// Delaunay edges and nearest neighbours; then every other pair is priced with the duals of vertices and blossoms, those
/// with negative slack join, and the solver starts again from the vertex duals until there is none. About
/// O(n log n) on layers of a print.
pub fn euclidean(points: &[Point]) -> Vec<u32> {
    let mut mates = vec![NONE; points.len()];
    let single = pair_coincident(points, &mut mates);
    let sites: Vec<Point> = single.iter().map(|&v| points[v as usize]).collect();
    for (v, &mate) in distinct(&sites).iter().enumerate() {
        mates[single[v] as usize] = single[mate as usize];
    }
    mates
}

/// Matches coincident points with each other; returns the one of each position that is left over, if any.
fn pair_coincident(points: &[Point], mates: &mut [u32]) -> Vec<u32> {
    let mut order: Vec<u32> = (0..points.len() as u32).collect();
    order.sort_unstable_by_key(|&v| (points[v as usize], v));
    let mut single = Vec::new();
    for group in order.chunk_by(|&u, &v| points[u as usize] == points[v as usize]) {
        let pairs = group.chunks_exact(2);
        single.extend(pairs.remainder());
        for pair in pairs {
            mates[pair[0] as usize] = pair[1];
            mates[pair[1] as usize] = pair[0];
        }
    }
    single
}

/// Matches points of which no two coincide. For an odd number there is one more vertex that costs nothing to match.
fn distinct(points: &[Point]) -> Vec<u32> {
    let n = points.len() as u32;
    let joker = (n % 2 == 1).then_some(n);
    let tree = KdTree::new(points);
    let mut pairs = candidates(points, &tree);
    let mut known: FxHashSet<(u32, u32)> = pairs.iter().copied().collect();
    let mut duals = None;
    loop {
        let edges: Vec<Edge> = pairs
            .iter()
            .map(|&(u, v)| (u, v, distance(points[u as usize], points[v as usize])))
            .chain(joker.into_iter().flat_map(|joker| (0..n).map(move |v| (v, joker, 0))))
            .collect();
        let graph = Graph::new((n + n % 2) as usize, &edges);
        let start = duals.map_or_else(|| graph.cheapest_halves(), |duals| graph.feasible(duals));
        let mut solver = Solver::new(&graph, &start);
        solver.match_greedily();
        let perfect = solver.run();
        debug_assert!(perfect, "the candidates hold a perfect matching");
        let family = solver.finish();
        let before = pairs.len();
        pairs.extend(violated(points, &tree, &family).into_iter().filter(|&pair| known.insert(pair)));
        if pairs.len() == before {
            return (0..n)
                .map(|v| family.mates[v as usize])
                .zip(0..)
                .map(|(u, v)| if u == n { v } else { u })
                .collect();
        }
        duals = Some(family.duals);
    }
}

/// Delaunay edges, nearest neighbours, and one arbitrary perfect matching, so that there is one.
fn candidates(points: &[Point], tree: &KdTree) -> Vec<(u32, u32)> {
    let mut pairs = delaunay(points);
    for v in 0..points.len() as u32 {
        let at = points[v as usize];
        let mut near: Vec<(i64, u32)> = Vec::with_capacity(NEAREST + 1);
        let enter =
            |near: &Vec<(i64, u32)>, _, d: f64| near.len() < NEAREST || d * d < near[NEAREST - 1].0 as f64;
        tree.search(at, &mut near, &enter, &mut |near, u| {
            let entry = (points[u as usize].distance2(at), u);
            if u != v && (near.len() < NEAREST || entry < near[NEAREST - 1]) {
                near.truncate(NEAREST - 1);
                near.insert(near.partition_point(|other| *other < entry), entry);
            }
        });
        pairs.extend(near.iter().map(|&(_, u)| (u.min(v), u.max(v))));
    }
    // The points come sorted, so neighbours in number are not far apart. A last one has the joker.
    pairs.extend((0..points.len() as u32 / 2).map(|k| (2 * k, 2 * k + 1)));
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

/// All pairs with negative slack under the duals of a family.
fn violated(points: &[Point], tree: &KdTree, family: &Family) -> Vec<(u32, u32)> {
    let sets = Sets::new(family);
    let potential = |v: u32| sets.sums[v as usize];
    let highest = tree.aggregate(i64::MIN, potential, i64::max);
    // The smallest set that holds all points of a node; an empty node is never entered.
    let common = tree.aggregate(None, Some, |a, b| match (a, b) {
        (Some(a), Some(b)) => Some(sets.meet(a, b)),
        (one, other) => one.or(other),
    });
    let mut found = Vec::new();
    for u in 0..points.len() as u32 {
        let (at, own) = (points[u as usize], potential(u));
        let enter = |_: &Vec<_>, node: usize, distance: f64| {
            let Some(set) = common[node] else { return false };
            // Both potentials, without the sets that hold both ends; first without the look at the sets.
            let least = (4.0 * distance) as i64 - own - highest[node];
            least < 0 && least + 2 * sets.sums[sets.meet(u, set) as usize] < 0
        };
        tree.search(at, &mut found, &enter, &mut |found, v| {
            if u < v {
                let slack = 4 * distance(at, points[v as usize]) - own - potential(v);
                if slack < 0 && slack + 2 * sets.sums[sets.meet(u, v) as usize] < 0 {
                    found.push((u, v));
                }
            }
        });
    }
    found
}

/// A laminar family with a search for the smallest common set of two, in O(log n) steps at any depth.
struct Sets {
    /// The set around each; around the outermost ones, and last, is one of everything, whose dual is zero.
    outer: Vec<u32>,
    /// A set farther out.
    jump: Vec<u32>,
    /// Number of sets around each.
    depths: Vec<u32>,
    /// Sum of the duals of a set and of all around it.
    sums: Vec<i64>,
}

impl Sets {
    fn new(family: &Family) -> Self {
        let everything = family.outer.len();
        let around = |&set: &u32| if set == NONE { everything as u32 } else { set };
        let outer: Vec<u32> = family.outer.iter().map(around).chain([everything as u32]).collect();
        let mut sets = Self {
            outer,
            jump: vec![NONE; everything],
            depths: vec![0; everything + 1],
            sums: vec![0; everything + 1],
        };
        sets.jump.push(everything as u32);
        let mut chain = Vec::new();
        for start in 0..everything {
            let mut set = start;
            while sets.jump[set] == NONE {
                chain.push(set);
                set = sets.outer[set] as usize;
            }
            while let Some(set) = chain.pop() {
                let outer = sets.outer[set] as usize;
                sets.sums[set] = sets.sums[outer] + family.duals[set];
                sets.depths[set] = sets.depths[outer] + 1;
                let far = sets.jump[outer] as usize;
                let farther = sets.jump[far] as usize;
                let balanced =
                    sets.depths[outer] - sets.depths[far] == sets.depths[far] - sets.depths[farther];
                sets.jump[set] = if balanced { farther } else { outer } as u32;
            }
        }
        sets
    }

    fn meet(&self, a: u32, b: u32) -> u32 {
        let (mut a, mut b) = (a as usize, b as usize);
        if self.depths[a] < self.depths[b] {
            (a, b) = (b, a);
        }
        while self.depths[a] > self.depths[b] {
            let far = self.jump[a] as usize;
            a = if self.depths[far] < self.depths[b] { self.outer[a] as usize } else { far };
        }
        while a != b {
            let next = if self.jump[a] == self.jump[b] { &self.outer } else { &self.jump };
            (a, b) = (next[a] as usize, next[b] as usize);
        }
        a as u32
    }
}
