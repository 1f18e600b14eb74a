//! Boolean operations on regions, exact on the grid but for the rounding of intersection points.
//!
//! Polygons that meet no other pass through untouched, as do polygons that are the same in both operands; outlines that
//! do not touch are only nested, and those that cross are cut there. Where outlines touch without crossing, or share
//! edges, they are moved so little that they no longer do. What still does, the sweep of `i_overlay` sorts out. All this cluster by
//! cluster.

use std::cell::RefCell;

use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay::{Overlay, ShapeType};
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::i_float::int::point::IntPoint;

use super::arrange::{Arrangement, Rule};
use super::crossed::Crossed;
use super::nudge;
use super::{Bounds, Point, Polygon, Region, Ring, ring_area};

thread_local! {
    /// The buffers of the sweep, kept from call to call.
    static OVERLAY: RefCell<Overlay<i32>> = RefCell::new(Overlay::new(256));
}

/// The area in both.
pub fn intersection(a: &Region, b: &Region) -> Region {
    let [both] = combine(a, b, [Rule::Both]);
    both
}

/// The area in either.
pub fn union(a: &Region, b: &Region) -> Region {
    let [either] = combine(a, b, [Rule::Either]);
    either
}

/// The area in `a` and not in `b`.
pub fn difference(a: &Region, b: &Region) -> Region {
    let [rest] = combine(a, b, [Rule::FirstOnly]);
    rest
}

/// Splits `a` into its parts inside and outside `b`. At little more than the cost of either.
pub fn split(a: &Region, b: &Region) -> (Region, Region) {
    let [both, rest] = combine(a, b, [Rule::Both, Rule::FirstOnly]);
    (both, rest)
}

/// The area in any of them.
pub fn union_all<'a>(regions: impl IntoIterator<Item = &'a Region>) -> Region {
    let polygons: Vec<&Polygon> = regions.into_iter().flat_map(|region| &region.polygons).collect();
    let boxes: Vec<Bounds> = polygons.iter().map(|p| p.bounds()).collect();
    let mut result = Region::default();
    for cluster in clusters(&boxes, |_, _| true) {
        let first = polygons[cluster[0]];
        if cluster[1..].iter().all(|&i| polygons[i] == first) {
            result.polygons.push(first.clone());
        } else {
            let rings = cluster.iter().flat_map(|&i| polygons[i].rings());
            result.polygons.extend(resolve(rings, Rule::NonZero).0.polygons);
        }
    }
    result
}

/// The area that rings of any orientation wind around at least once (non-zero rule), as a region.
pub fn unite_rings(rings: &[Ring]) -> Region {
    resolve(rings, Rule::NonZero).0
}

/// The area that the rings wind around a positive number of times, and whether they are its rings already.
pub(super) fn positive(rings: &[Ring]) -> (Region, bool) {
    let (region, are_apart) = resolve(rings, Rule::Positive);
    let are_all = are_apart && region.rings().count() == rings.len();
    (region, are_all)
}

/// The region that a rule leaves of rings, and whether they meet nowhere.
fn resolve<'a>(rings: impl IntoIterator<Item = &'a Ring>, rule: Rule) -> (Region, bool) {
    Arrangement::with(rings, [], |arrangement| {
        let cross = arrangement.find_crossings();
        let are_apart = cross.is_some() && arrangement.crossings().is_empty();
        // Nothing is around a single one.
        if let (&[(start, end)], true) = (arrangement.spans(), are_apart) {
            return (alone(arrangement.points()[start..end].to_vec(), rule), true);
        }
        let mut crossed = cross.and_then(|()| Crossed::new(arrangement));
        (of_rule(arrangement, crossed.as_mut(), rule), are_apart)
    })
}

/// The region that a rule leaves of a ring that does not meet itself.
fn alone(mut ring: Ring, rule: Rule) -> Region {
    let is_outer = ring_area(&ring) > 0.0;
    if !rule.inside([if is_outer { 1 } else { -1 }, 0]) {
        return Region::default();
    }
    if !is_outer {
        ring.reverse();
    }
    Region::from(Polygon { outer: ring, holes: Vec::new() })
}

/// Groups of boxes that are connected by touching pairs for which `links` holds, each ascending, in the order of
/// their first members.
pub(super) fn clusters(boxes: &[Bounds], links: impl Fn(usize, usize) -> bool) -> Vec<Vec<usize>> {
    match boxes {
        [_] => return vec![vec![0]],
        [a, b] if links(0, 1) && a.touches(b) => return vec![vec![0, 1]],
        [_, _] => return vec![vec![0], vec![1]],
        _ => {}
    }
    let mut order: Vec<usize> = (0..boxes.len()).collect();
    order.sort_by_key(|&i| (boxes[i].min.x, i));
    let mut root: Vec<usize> = (0..boxes.len()).collect();
    fn find(root: &mut [usize], mut i: usize) -> usize {
        while root[i] != i {
            root[i] = root[root[i]];
            i = root[i];
        }
        i
    }
    for (k, &i) in order.iter().enumerate() {
        for &j in order[k + 1..].iter().take_while(|&&j| boxes[j].min.x <= boxes[i].max.x) {
            if links(i, j) && boxes[i].touches(&boxes[j]) {
                let (a, b) = (find(&mut root, i), find(&mut root, j));
                // The smallest member is the root.
                root[a.max(b)] = a.min(b);
            }
        }
    }
    let mut group_of = vec![usize::MAX; boxes.len()];
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for i in 0..boxes.len() {
        let r = find(&mut root, i);
        if group_of[r] == usize::MAX {
            group_of[r] = groups.len();
            groups.push(Vec::new());
        }
        groups[group_of[r]].push(i);
    }
    groups
}

fn combine<const N: usize>(a: &Region, b: &Region, rules: [Rule; N]) -> [Region; N] {
    let split = a.polygons.len();
    let polygons: Vec<&Polygon> = a.polygons.iter().chain(&b.polygons).collect();
    let boxes: Vec<Bounds> = polygons.iter().map(|p| p.bounds()).collect();
    let mut results = [const { Region { polygons: Vec::new() } }; N];
    for cluster in clusters(&boxes, |i, j| (i < split) != (j < split)) {
        let (in_a, in_b) = cluster.split_at(cluster.partition_point(|&i| i < split));
        let same =
            in_a.len() == in_b.len() && in_a.iter().zip(in_b).all(|(&i, &j)| polygons[i] == polygons[j]);
        if same || in_a.is_empty() || in_b.is_empty() {
            for (result, rule) in results.iter_mut().zip(rules) {
                let whole = match rule {
                    Rule::Both if !same => &[],
                    Rule::FirstOnly if same => &[],
                    Rule::Either if in_a.is_empty() => in_b,
                    _ => in_a,
                };
                result.polygons.extend(whole.iter().map(|&i| polygons[i].clone()));
            }
            continue;
        }
        let [in_a, in_b] = [in_a, in_b].map(|part| part.iter().flat_map(|&i| polygons[i].rings()));
        Arrangement::with(in_a, in_b, |arrangement| {
            let cross = arrangement.find_crossings();
            let mut crossed = cross.and_then(|()| Crossed::new(arrangement));
            for (result, rule) in results.iter_mut().zip(rules) {
                result.polygons.extend(of_rule(arrangement, crossed.as_mut(), rule).polygons);
            }
        });
    }
    results
}

/// The region that a rule leaves of any rings, which are cut where they cross unless some touch.
fn of_rule(arrangement: &Arrangement, crossed: Option<&mut Crossed<'_>>, rule: Rule) -> Region {
    let region = crossed.and_then(|crossed| crossed.region(rule));
    region.or_else(|| nudge::region(arrangement, rule)).unwrap_or_else(|| sweep(arrangement, rule))
}

/// The region that a rule leaves of any rings.
fn sweep(arrangement: &Arrangement, rule: Rule) -> Region {
    let (rule, fill) = match rule {
        Rule::NonZero => (OverlayRule::Subject, FillRule::NonZero),
        Rule::Positive => (OverlayRule::Subject, FillRule::Positive),
        Rule::Both => (OverlayRule::Intersect, FillRule::NonZero),
        Rule::Either => (OverlayRule::Union, FillRule::NonZero),
        Rule::FirstOnly => (OverlayRule::Difference, FillRule::NonZero),
    };
    let shapes = OVERLAY.with_borrow_mut(|overlay| {
        overlay.clear();
        for (ring, &(start, end)) in arrangement.spans().iter().enumerate() {
            let role = if arrangement.is_second(ring) { ShapeType::Clip } else { ShapeType::Subject };
            overlay.add_path_iter(
                arrangement.points()[start..end].iter().map(|p| IntPoint::new(p.x, p.y)),
                role,
            );
        }
        overlay.overlay(rule, fill)
    });
    let ring =
        |contour: Vec<IntPoint<i32>>| -> Ring { contour.into_iter().map(|p| Point::new(p.x, p.y)).collect() };
    let polygons = shapes.into_iter().filter_map(|shape| {
        let mut rings = shape.into_iter().map(ring);
        let outer = rings.next()?;
        Some(Polygon { outer, holes: rings.collect() })
    });
    Region { polygons: polygons.collect() }
}
