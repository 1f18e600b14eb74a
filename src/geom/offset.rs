//! Growing and shrinking regions.

use i_overlay::i_float::int::angle::Angle;
use i_overlay::i_float::int::point::IntPoint;
use i_overlay::mesh::int::outline::offset::IntOutlineOffset;
use i_overlay::mesh::int::style::{IntLineJoin, IntOutlineStyle};

use super::boolean::from_shapes;
use super::{Region, to_units};

/// The region grown (`by_mm` > 0) or shrunk (`by_mm` < 0) by a distance; corners are mitred.
pub fn offset(region: &Region, by_mm: f64) -> Region {
    let by = to_units(by_mm);
    if by == 0 || region.is_empty() {
        return region.clone();
    }
    let style = IntOutlineStyle::new(by)
        .line_join(IntLineJoin::Miter(Angle::from_radians(1.0_f64).unwrap_or(Angle::from_bits(1 << 29))));
    let mut out = Region::default();
    let islands: Vec<Vec<Vec<IntPoint<i32>>>> = region
        .polygons
        .iter()
        .map(|p| p.rings().map(|r| r.iter().map(|p| IntPoint::new(p.x, p.y)).collect()).collect())
        .collect();
    if by > 0 {
        if let Ok(shapes) = islands.outline(&style) {
            out = from_shapes(shapes);
        }
    } else {
        for island in &islands {
            if let Ok(shapes) = island.outline(&style) {
                out.polygons.extend(from_shapes(shapes).polygons);
            }
        }
    }
    out
}

/// What is left after shrinking and growing back: parts narrower than twice the radius vanish.
pub fn opening(region: &Region, radius_mm: f64) -> Region {
    offset(&offset(region, -radius_mm), radius_mm)
}
