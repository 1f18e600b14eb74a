//! Rings that neither cross nor touch → a region, without a boolean operation.
//!
//! Most sections of sound meshes are like that, and proving it takes a fraction of the time of a union.

use geometry::{Bounds, Point, Polygon, Region, Ring, ring_area, ring_contains};

/// Comparisons allowed for each edge before the proof is given up.
const PATIENCE: usize = 100;

/// What the rings wind around (non-zero rule), or `None` unless every ring is proved simple and apart from the others.
///
/// All tests are exact. O(n log n) for n edges, each beside few others along x.
pub(super) fn assemble(rings: &[Ring]) -> Option<Region> {
    if !are_apart(rings) {
        return None;
    }
    let bounds: Vec<Bounds> = rings.iter().map(|r| Bounds::of(r.iter().copied())).collect::<Option<_>>()?;
    let areas: Vec<f64> = rings.iter().map(|r| ring_area(r)).collect();
    let turn = |ring: usize| if areas[ring] > 0.0 { 1 } else { -1 };
    let mut polygons: Vec<Polygon> = Vec::new();
    let mut polygon_of = vec![None; rings.len()];
    let mut holes = Vec::new();
    for inner in 0..rings.len() {
        let around = (0..rings.len()).filter(|&outer| {
            outer != inner
                && encloses(&bounds[outer], &bounds[inner])
                && ring_contains(&rings[outer], rings[inner][0])
        });
        let around: Vec<usize> = around.collect();
        let outside: i32 = around.iter().map(|&ring| turn(ring)).sum();
        let inside = outside + turn(inner);
        if outside == 0 {
            polygon_of[inner] = Some(polygons.len());
            polygons.push(Polygon { outer: turned(&rings[inner], areas[inner] > 0.0), holes: Vec::new() });
        } else if inside == 0 {
            holes.push((inner, around));
        }
    }
    for (hole, around) in holes {
        // The innermost outer ring around it.
        let outers = around.into_iter().filter(|&ring| polygon_of[ring].is_some());
        let outer = outers.min_by(|&a, &b| areas[a].abs().total_cmp(&areas[b].abs()))?;
        polygons[polygon_of[outer]?].holes.push(turned(&rings[hole], areas[hole] < 0.0));
    }
    Some(Region::disjoint(polygons))
}

fn turned(ring: &Ring, keep: bool) -> Ring {
    if keep { ring.clone() } else { ring.iter().rev().copied().collect() }
}

fn encloses(outer: &Bounds, inner: &Bounds) -> bool {
    outer.min.x < inner.min.x
        && outer.min.y < inner.min.y
        && inner.max.x < outer.max.x
        && inner.max.y < outer.max.y
}

/// An edge of a ring, ends sorted by x.
#[derive(Clone, Copy)]
struct Edge {
    left: Point,
    right: Point,
    low: i32,
    high: i32,
    /// Numbers of the vertices at both ends, over all rings: edges with one in common are neighbours.
    ends: [u32; 2],
}

/// Whether no edge meets another but its neighbours, and those only at their common vertex. A sweep along x.
fn are_apart(rings: &[Ring]) -> bool {
    let mut edges = Vec::with_capacity(rings.iter().map(Vec::len).sum());
    for ring in rings {
        let first = edges.len() as u32;
        for (i, &a) in ring.iter().enumerate() {
            let next = if i + 1 == ring.len() { 0 } else { i + 1 };
            let b = ring[next];
            let (left, right) = if (a.x, a.y) <= (b.x, b.y) { (a, b) } else { (b, a) };
            let ends = [first + i as u32, first + next as u32];
            edges.push(Edge { left, right, low: a.y.min(b.y), high: a.y.max(b.y), ends });
        }
    }
    edges.sort_unstable_by_key(|e| (e.left.x, e.left.y, e.ends));
    let mut patience = PATIENCE * edges.len();
    let mut active: Vec<Edge> = Vec::new();
    for edge in edges {
        if active.len() > patience {
            return false;
        }
        patience -= active.len();
        let mut met = false;
        active.retain(|other| {
            if other.right.x < edge.left.x {
                return false;
            }
            met |= other.high >= edge.low && other.low <= edge.high && meet(other, &edge);
            true
        });
        if met {
            return false;
        }
        active.push(edge);
    }
    true
}

/// Whether two edges have a point in common, a vertex shared by neighbours aside.
fn meet(e: &Edge, f: &Edge) -> bool {
    let side = |e: &Edge, p: Point| (e.right - e.left).cross(p - e.left).signum();
    let common = e.ends.iter().any(|end| f.ends.contains(end));
    let (a, b) = (side(e, f.left), side(e, f.right));
    if common {
        // On one line, neighbours may only lie end to end.
        return a == 0 && b == 0 && !(e.right == f.left || f.right == e.left);
    }
    a * b <= 0 && side(f, e.left) * side(f, e.right) <= 0
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::{difference, unite_rings};
    use proptest::prelude::*;

    fn square(x: i32, y: i32, side: i32, hole: bool) -> Ring {
        let ring =
            [(x, y), (x + side, y), (x + side, y + side), (x, y + side)].map(|(x, y)| Point::new(x, y));
        turned(&ring.to_vec(), !hole)
    }

    #[test]
    fn rings_in_rings_become_polygons_with_holes() {
        let rings = [
            square(0, 0, 1000, false),
            square(100, 100, 800, true),
            square(200, 200, 600, false),
            square(300, 300, 100, true),
            square(310, 310, 50, false),
            square(250, 600, 20, false),
        ];
        let region = assemble(&rings).expect("the rings are apart");
        assert_eq!(region.polygons().iter().map(|p| p.holes.len()).collect::<Vec<_>>(), [1, 1, 0]);
        assert_eq!(region.area_mm2(), unite_rings(&rings).area_mm2());
    }

    #[test]
    fn rings_that_touch_cross_or_fold_are_left_to_the_union() {
        let spike = [(0, 0), (100, 0), (100, 100), (300, 100), (100, 100), (0, 100)];
        let bow = [(0, 0), (100, 100), (100, 0), (0, 100)];
        let as_ring = |points: &[(i32, i32)]| points.iter().map(|&(x, y)| Point::new(x, y)).collect::<Ring>();
        let cases = [
            vec![square(0, 0, 100, false), square(50, 50, 100, false)],
            vec![square(0, 0, 100, false), square(100, 20, 10, false)],
            vec![square(0, 0, 100, false), square(100, 100, 100, false)],
            vec![square(0, 0, 100, false), square(0, 0, 100, true)],
            vec![as_ring(&spike)],
            vec![as_ring(&bow)],
        ];
        assert!(cases.iter().all(|rings| assemble(rings).is_none()));
    }

    proptest! {
        #[test]
        fn what_is_assembled_is_the_union(
            squares in prop::collection::vec((0i32..400, 0i32..400, 1i32..200, any::<bool>()), 1..7),
            corners in prop::collection::vec((0i32..400, 0i32..400), 3..6),
        ) {
            let mut rings: Vec<Ring> = squares.iter().map(|&(x, y, s, hole)| square(x, y, s, hole)).collect();
            rings.push(corners.iter().map(|&(x, y)| Point::new(x, y)).collect());
            if let Some(region) = assemble(&rings) {
                let union = unite_rings(&rings);
                prop_assert!(difference(&region, &union).is_empty() && difference(&union, &region).is_empty());
            }
        }
    }
}
