//! Brim, raft and skirt.

use std::f64::consts::FRAC_PI_2;

use geo::ConvexHull;

use super::options::{BrimSettings, BrimSides, RaftSettings, SkirtSettings};
use geometry::{Point, Polygon, Region, Ring};

use super::bead::Line;
use super::infill::{Joins, lines};
use super::{Path, Phase, Role, Width, bead};

/// Layers at the top of a raft that are solid.
const SOLID_RAFT_LAYERS: u32 = 2;

/// Ends of a raft's lines are joined up to this many line distances apart.
const LONGEST_JOIN: f64 = 4.0;

/// Loops around the footprint, innermost first: the brim. Where a loop would come too near to a part of the footprint
/// that has no brim it is interrupted.
pub fn brim(footprint: &Region, settings: &BrimSettings, width_mm: f64, height_mm: f64) -> Vec<Line> {
    let spacing_mm = bead::spacing_mm(width_mm, height_mm);
    let count = (settings.width.0 / spacing_mm).round() as usize;
    let is_small = |p: &Polygon| settings.max_area <= 0.0 || p.area_mm2() < settings.max_area;
    let (own, others): (Vec<Polygon>, Vec<Polygon>) =
        footprint.polygons().iter().cloned().partition(is_small);
    let (own, others) = (Region::disjoint(own), Region::disjoint(others));
    let away_mm = |k: usize| settings.gap.0 + width_mm / 2.0 + k as f64 * spacing_mm;
    let mut rings: Vec<Ring> = Vec::new();
    let filled = without_holes(&own);
    if settings.sides != BrimSides::Inner {
        rings.extend((0..count).flat_map(|k| {
            without_holes(&geometry::offset(&filled, away_mm(k))).into_polygons().into_iter().map(|p| p.outer)
        }));
    }
    if settings.sides != BrimSides::Outer {
        let holes = geometry::difference(&filled, &own);
        rings.extend(
            (0..count)
                .flat_map(|k| geometry::offset(&holes, -away_mm(k)).rings().cloned().collect::<Vec<_>>()),
        );
    }
    let loops = rings.into_iter().filter(|ring| ring.len() >= 3);
    if others.is_empty() {
        return loops.map(|points| Line::nominal(points, true)).collect();
    }
    let reach_mm = away_mm(count) + width_mm;
    let area =
        geometry::difference(&geometry::offset(&filled, reach_mm), &geometry::offset(&others, away_mm(0)));
    loops.flat_map(|ring| interrupted(ring, &area)).collect()
}

/// The parts of a loop inside an area; the loop, if that is all of it.
fn interrupted(mut ring: Ring, area: &Region) -> Vec<Line> {
    ring.extend(ring.first().copied());
    let pieces = geometry::clip_polyline(area, &ring);
    match pieces.as_slice() {
        [whole] if whole.points == ring => {
            ring.pop();
            vec![Line::nominal(ring, true)]
        }
        _ => pieces.into_iter().map(|p| Line::nominal(p.points, false)).collect(),
    }
}

/// Loops around the convex hull of everything, outermost first: the skirt. There are as many as requested, and
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
        let Some(polygon) = geometry::offset(&hull, away_mm).into_polygons().into_iter().next() else {
            break;
        };
        length_mm += geometry::ring_length_mm(&polygon.outer);
        loops.push(polygon.outer);
    }
    loops.reverse();
    loops
}

/// Where a raft lies: under everything that stands on it, and around it; places between are filled.
pub fn raft_area(footprint: &Region, settings: &RaftSettings) -> Region {
    let margin_mm = settings.margin.0.max(0.1);
    geometry::offset(&geometry::closing(footprint, 2.0 * margin_mm), margin_mm)
}

/// The beads of one layer of a raft, 0 the lowest: a loop and parallel lines, turned by 90° from layer to layer, the
/// uppermost ones solid.
pub fn raft(area: &Region, layer: u32, settings: &RaftSettings, width_mm: f64, height_mm: f64) -> Vec<Path> {
    let is_solid = layer + SOLID_RAFT_LAYERS >= settings.layers;
    let role = if is_solid { Role::SupportInterface } else { Role::Support };
    let spacing_mm = bead::spacing_mm(width_mm, height_mm);
    let distance_mm = if is_solid { spacing_mm } else { spacing_mm / settings.density.0 };
    let frame = geometry::offset(area, -width_mm / 2.0);
    let loops = frame.rings().map(|ring| Line::nominal(ring.clone(), true));
    let angle_rad = if layer % 2 == 1 { FRAC_PI_2 } else { 0.0 };
    let inside = geometry::offset(&frame, -spacing_mm);
    let joins = Joins { longest_mm: LONGEST_JOIN * distance_mm, ..Joins::default() };
    let lines = lines::parallel(&inside, angle_rad, distance_mm, 0.0, &joins);
    let width = Width::Constant(width_mm);
    loops
        .chain(lines)
        .filter(|line| line.points.len() >= 2 + usize::from(line.closed))
        .map(|line| {
            let (closed, points, width) = (line.closed, line.points, width.clone());
            Path { role, closed, points, width, height_mm, island: None, phase: Phase::Support, tool: None }
        })
        .collect()
}

fn without_holes(region: &Region) -> Region {
    let rings: Vec<Ring> = region.polygons().iter().map(|p| p.outer.clone()).collect();
    geometry::unite_rings(&rings)
}

fn hull(region: &Region) -> Option<Region> {
    let points: geo::MultiPoint<f64> =
        region.polygons().iter().flat_map(|p| &p.outer).map(|p| geo::Point::from(p.mm())).collect();
    let outer: Ring =
        points.convex_hull().exterior().coords().skip(1).map(|c| Point::from_mm(c.x, c.y)).collect();
    (outer.len() >= 3).then(|| Region::from(Polygon { outer, holes: Vec::new() }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::Mm;
    use geometry::{polyline_length_mm, ring_area, ring_length_mm};

    const WIDTH_MM: f64 = 0.45;
    const HEIGHT_MM: f64 = 0.2;

    fn square(x: f64, side: f64) -> Ring {
        [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
            .map(|(dx, dy)| Point::from_mm(x + dx * side, dy * side))
            .to_vec()
    }

    fn loops(footprint: &Region, settings: BrimSettings) -> Vec<Line> {
        brim(footprint, &BrimSettings { width: Mm(3.0), ..settings }, WIDTH_MM, HEIGHT_MM)
    }

    #[test]
    fn a_brim_of_three_millimetres_has_seven_loops_on_each_side() {
        let mut hole = square(10.0, 10.0).iter().map(|&p| p + Point::from_mm(0.0, 10.0)).collect::<Ring>();
        hole.reverse();
        let ring = Region::from(Polygon { outer: square(0.0, 30.0), holes: vec![hole] });
        for (sides, outside, inside) in
            [(BrimSides::Outer, 7, 0), (BrimSides::Inner, 0, 7), (BrimSides::Both, 7, 7)]
        {
            let found = loops(&ring, BrimSettings { sides, ..BrimSettings::default() });
            let areas: Vec<f64> = found.iter().map(|line| ring_area(&line.points).abs()).collect();
            assert_eq!(areas.iter().filter(|a| **a > 900.0).count(), outside, "{sides:?}");
            assert_eq!(areas.iter().filter(|a| **a < 100.0).count(), inside, "{sides:?}");
            assert_eq!(areas.len(), outside + inside);
        }
    }

    #[test]
    fn only_a_small_foot_has_a_brim_which_keeps_off_the_large_one() {
        let alone = |x, side| Polygon { outer: square(x, side), holes: Vec::new() };
        let footprint = Region::disjoint([alone(0.0, 30.0), alone(31.5, 5.0)]);
        let found = loops(&footprint, BrimSettings { max_area: 100.0, ..BrimSettings::default() });
        assert!(found.iter().any(|line| line.closed) && found.iter().any(|line| !line.closed));
        let large = Region::disjoint(footprint.polygons()[..1].to_vec());
        let near = geometry::offset(&large, WIDTH_MM / 2.0 - 0.01);
        assert!(found.iter().flat_map(|line| &line.points).all(|&p| !near.contains(p)));
        assert!(loops(&footprint, BrimSettings { max_area: 1.0, ..BrimSettings::default() }).is_empty());
    }

    #[test]
    fn a_raft_is_sparse_below_and_solid_above() {
        let settings = RaftSettings { layers: 4, ..RaftSettings::default() };
        let area = raft_area(&Region::from(Polygon { outer: square(0.0, 30.0), holes: vec![] }), &settings);
        assert!((area.area_mm2() - 36.0 * 36.0).abs() < 1.0);
        let share = |layer| {
            let paths = raft(&area, layer, &settings, WIDTH_MM, HEIGHT_MM);
            let length_mm =
                |p: &Path| if p.closed { ring_length_mm(&p.points) } else { polyline_length_mm(&p.points) };
            paths.iter().map(length_mm).sum::<f64>() * bead::spacing_mm(WIDTH_MM, HEIGHT_MM) / area.area_mm2()
        };
        for (layer, least, most) in [(0, 0.5, 0.65), (1, 0.5, 0.65), (2, 0.95, 1.03), (3, 0.95, 1.03)] {
            assert!((least..most).contains(&share(layer)), "layer {layer}: {}", share(layer));
        }
    }
}
