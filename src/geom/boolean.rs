//! Boolean operations on regions, exact on the grid but for the rounding of intersection points.

use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay::{Overlay, ShapeType};
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::i_float::int::point::IntPoint;

use super::{Point, Polygon, Region, Ring};

fn add(overlay: &mut Overlay<i32>, region: &Region, kind: ShapeType) {
    for ring in region.rings() {
        overlay.add_path_iter(ring.iter().map(|p| IntPoint::new(p.x, p.y)), kind);
    }
}

pub(super) fn from_shapes(shapes: Vec<Vec<Vec<IntPoint<i32>>>>) -> Region {
    let ring = |c: Vec<IntPoint<i32>>| -> Ring { c.into_iter().map(|p| Point::new(p.x, p.y)).collect() };
    Region {
        polygons: shapes
            .into_iter()
            .filter_map(|shape| {
                let mut rings = shape.into_iter().map(ring);
                let outer = rings.next()?;
                Some(Polygon { outer, holes: rings.collect() })
            })
            .collect(),
    }
}

fn combine(a: &Region, b: &Region, rule: OverlayRule) -> Region {
    let mut overlay = Overlay::new(a.vertex_count() + b.vertex_count());
    add(&mut overlay, a, ShapeType::Subject);
    add(&mut overlay, b, ShapeType::Clip);
    from_shapes(overlay.overlay(rule, FillRule::NonZero))
}

/// The area in both.
pub fn intersection(a: &Region, b: &Region) -> Region {
    if a.is_empty() || b.is_empty() {
        return Region::default();
    }
    combine(a, b, OverlayRule::Intersect)
}

/// The area in either.
pub fn union(a: &Region, b: &Region) -> Region {
    if a.is_empty() {
        return b.clone();
    }
    if b.is_empty() {
        return a.clone();
    }
    combine(a, b, OverlayRule::Union)
}

/// The area in any of them.
pub fn union_all<'a>(regions: impl IntoIterator<Item = &'a Region>) -> Region {
    let mut overlay = Overlay::new(64);
    for region in regions {
        add(&mut overlay, region, ShapeType::Subject);
    }
    from_shapes(overlay.overlay(OverlayRule::Subject, FillRule::NonZero))
}

/// The area in `a` and not in `b`.
pub fn difference(a: &Region, b: &Region) -> Region {
    if a.is_empty() || b.is_empty() {
        return a.clone();
    }
    combine(a, b, OverlayRule::Difference)
}

/// The area that rings of any orientation wind around at least once (non-zero rule), as a region.
pub fn unite_rings(rings: &[Ring]) -> Region {
    let mut overlay = Overlay::new(rings.iter().map(Vec::len).sum());
    for ring in rings {
        overlay.add_path_iter(ring.iter().map(|p| IntPoint::new(p.x, p.y)), ShapeType::Subject);
    }
    from_shapes(overlay.overlay(OverlayRule::Subject, FillRule::NonZero))
}
