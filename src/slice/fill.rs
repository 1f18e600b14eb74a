//! Outlines of any kind → the area inside.

use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay::{Overlay, ShapeType};
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::i_float::int::point::IntPoint;

use super::nest;
use geometry::{Point, Polygon, Region, Ring};

/// The area that the rings wind around: bodies that overlap or touch become one, and so do those with gaps narrower
/// than twice `closing_mm` between them.
pub(super) fn non_zero(rings: &[Ring], closing_mm: f64) -> Region {
    match nest::assemble(rings) {
        Some(region) if closing_mm > 0.0 => geometry::close_between(&region, closing_mm),
        Some(region) => region,
        // Where bodies touch along a part of their sides, the gaps are slits in one outline.
        None => geometry::closing(&geometry::unite_rings(rings), closing_mm),
    }
}

/// What a ray leaves through an odd number of rings: for meshes that do not say where outside is.
pub(super) fn even_odd(rings: &[Ring]) -> Region {
    let mut overlay = Overlay::new(rings.iter().map(Vec::len).sum());
    for ring in rings {
        overlay.add_path_iter(ring.iter().map(|p| IntPoint::new(p.x, p.y)), ShapeType::Subject);
    }
    let shapes = overlay.overlay(OverlayRule::Subject, FillRule::EvenOdd);
    let polygons = shapes.into_iter().filter_map(|shape| {
        let mut rings = shape.into_iter().map(|c| c.into_iter().map(|p| Point::new(p.x, p.y)).collect());
        Some(Polygon { outer: rings.next()?, holes: rings.collect() })
    });
    Region::disjoint(polygons)
}
