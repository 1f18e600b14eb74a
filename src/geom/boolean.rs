//! Boolean operations on regions, exact on the grid but for the rounding of intersection points.
//!
//! Polygons that meet no other pass through untouched, as do polygons that are the same in both operands;
//! only the rest goes through the sweep of `i_overlay`, cluster by cluster.

use std::cell::RefCell;

use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay::{Overlay, ShapeType};
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::i_float::int::point::IntPoint;

use super::arrange::{Arrangement, Rule};
use super::{Bounds, Point, Polygon, Region, Ring};

thread_local! {
    /// The buffers of the sweep, kept from call to call.
    static OVERLAY: RefCell<Overlay<i32>> = RefCell::new(Overlay::new(256));
}

/// The area in both.
pub fn intersection(a: &Region, b: &Region) -> Region {
    combine(a, b, OverlayRule::Intersect)
}

/// The area in either.
pub fn union(a: &Region, b: &Region) -> Region {
    combine(a, b, OverlayRule::Union)
}

/// The area in `a` and not in `b`.
pub fn difference(a: &Region, b: &Region) -> Region {
    combine(a, b, OverlayRule::Difference)
}

/// The area in any of them.
pub fn union_all<'a>(regions: impl IntoIterator<Item = &'a Region>) -> Region {
    let polygons: Vec<&Polygon> = regions.into_iter().flat_map(|region| &region.polygons).collect();
    let boxes: Vec<Bounds> = polygons.iter().map(|p| bounds(p)).collect();
    let mut result = Region::default();
    for cluster in clusters(&boxes, |_, _| true) {
        let first = polygons[cluster[0]];
        if cluster[1..].iter().all(|&i| polygons[i] == first) {
            result.polygons.push(first.clone());
        } else {
            let rings = cluster.iter().flat_map(|&i| polygons[i].rings());
            result.polygons.extend(sweep(rings, [], OverlayRule::Subject, FillRule::NonZero).polygons);
        }
    }
    result
}

/// The area that rings of any orientation wind around at least once (non-zero rule), as a region.
pub fn unite_rings(rings: &[Ring]) -> Region {
    let clean: Vec<Ring> = rings
        .iter()
        .map(|ring| {
            let mut ring = ring.clone();
            ring.dedup();
            while ring.len() > 1 && ring.last() == ring.first() {
                ring.pop();
            }
            ring
        })
        .collect();
    let arrangement = Arrangement::new(clean);
    if arrangement.is_simple() {
        return arrangement.into_region(Rule::NonZero);
    }
    sweep(&arrangement.into_rings(), [], OverlayRule::Subject, FillRule::NonZero)
}

/// The area that the rings wind around a positive number of times.
pub(super) fn positive(rings: impl IntoIterator<Item = Ring>) -> Region {
    let rings: Vec<Ring> = rings.into_iter().collect();
    sweep(&rings, [], OverlayRule::Subject, FillRule::Positive)
}

/// Groups of boxes that are connected by touching pairs for which `links` holds, each ascending, in the order of
/// their first members.
pub(super) fn clusters(boxes: &[Bounds], links: impl Fn(usize, usize) -> bool) -> Vec<Vec<usize>> {
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
    let mut place = vec![usize::MAX; boxes.len()];
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for i in 0..boxes.len() {
        let r = find(&mut root, i);
        if place[r] == usize::MAX {
            place[r] = groups.len();
            groups.push(Vec::new());
        }
        groups[place[r]].push(i);
    }
    groups
}

fn combine(a: &Region, b: &Region, rule: OverlayRule) -> Region {
    let split = a.polygons.len();
    let polygons: Vec<&Polygon> = a.polygons.iter().chain(&b.polygons).collect();
    let boxes: Vec<Bounds> = polygons.iter().map(|p| bounds(p)).collect();
    let mut result = Region::default();
    for cluster in clusters(&boxes, |i, j| (i < split) != (j < split)) {
        let (in_a, in_b) = cluster.split_at(cluster.partition_point(|&i| i < split));
        let same =
            in_a.len() == in_b.len() && in_a.iter().zip(in_b).all(|(&i, &j)| polygons[i] == polygons[j]);
        let whole = match rule {
            OverlayRule::Intersect if in_a.is_empty() || in_b.is_empty() => continue,
            OverlayRule::Difference if in_a.is_empty() || same => continue,
            OverlayRule::Union if in_a.is_empty() => in_b,
            OverlayRule::Intersect | OverlayRule::Union if same => in_a,
            OverlayRule::Union | OverlayRule::Difference if in_b.is_empty() => in_a,
            _ => {
                let rings =
                    |part: &[usize]| part.iter().flat_map(|&i| polygons[i].rings()).collect::<Vec<_>>();
                result.polygons.extend(sweep(rings(in_a), rings(in_b), rule, FillRule::NonZero).polygons);
                continue;
            }
        };
        result.polygons.extend(whole.iter().map(|&i| polygons[i].clone()));
    }
    result
}

fn bounds(polygon: &Polygon) -> Bounds {
    Bounds::of(polygon.outer.iter().copied())
        .unwrap_or(Bounds { min: Point::default(), max: Point::default() })
}

fn sweep<'a>(
    subject: impl IntoIterator<Item = &'a Ring>,
    clip: impl IntoIterator<Item = &'a Ring>,
    rule: OverlayRule,
    fill: FillRule,
) -> Region {
    let grid = |p: &Point| IntPoint::new(p.x, p.y);
    let shapes = OVERLAY.with_borrow_mut(|overlay| {
        overlay.clear();
        for ring in subject {
            overlay.add_path_iter(ring.iter().map(grid), ShapeType::Subject);
        }
        for ring in clip {
            overlay.add_path_iter(ring.iter().map(grid), ShapeType::Clip);
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
