//! Skirt and brim: loops around the part on the first layers.

use geo::ConvexHull;

use crate::geom::{self, Point, Polygon, Region, Ring};
use crate::profile::{BrimSettings, SkirtSettings};

use super::bead;

/// Loops around the footprint, innermost first: the brim. Holes of the footprint get none.
pub fn brim(footprint: &Region, settings: &BrimSettings, width_mm: f64, height_mm: f64) -> Vec<Ring> {
    let spacing_mm = bead::spacing_mm(width_mm, height_mm);
    let count = (settings.width.0 / spacing_mm).round() as usize;
    let filled = without_holes(footprint);
    (0..count)
        .flat_map(|k| {
            let away_mm = settings.gap.0 + width_mm / 2.0 + k as f64 * spacing_mm;
            without_holes(&geom::offset(&filled, away_mm)).polygons.into_iter().map(|p| p.outer)
        })
        .collect()
}

/// Loops around the convex hull of everything, outermost first: the skirt. There are as many as asked for, and
/// more until `min_length` is reached.
pub fn skirt(footprint: &Region, settings: &SkirtSettings, width_mm: f64, height_mm: f64) -> Vec<Ring> {
    let Some(hull) = hull(footprint) else {
        return Vec::new();
    };
    let spacing_mm = bead::spacing_mm(width_mm, height_mm);
    let mut loops: Vec<Ring> = Vec::new();
    let mut length_mm = 0.0;
    while loops.len() < settings.loops as usize || (settings.loops > 0 && length_mm < settings.min_length.0) {
        let away_mm = settings.distance.0 + width_mm / 2.0 + loops.len() as f64 * spacing_mm;
        let Some(polygon) = geom::offset(&hull, away_mm).polygons.into_iter().next() else {
            break;
        };
        length_mm += geom::ring_length_mm(&polygon.outer);
        loops.push(polygon.outer);
    }
    loops.reverse();
    loops
}

fn without_holes(region: &Region) -> Region {
    let rings: Vec<Ring> = region.polygons.iter().map(|p| p.outer.clone()).collect();
    geom::unite_rings(&rings)
}

fn hull(region: &Region) -> Option<Region> {
    let points: geo::MultiPoint<f64> =
        region.polygons.iter().flat_map(|p| &p.outer).map(|p| geo::Point::from(p.mm())).collect();
    let outer: Ring =
        points.convex_hull().exterior().coords().skip(1).map(|c| Point::from_mm(c.x, c.y)).collect();
    (outer.len() >= 3).then(|| Region { polygons: vec![Polygon { outer, holes: Vec::new() }] })
}
