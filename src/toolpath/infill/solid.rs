//! Solid infill: parallel lines side by side, their distance fitted so that they fill each patch exactly.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use geometry::{Bounds, Boxes, Direction, Point, Polygon, Region};

use super::super::bead::Line;
use super::spec::{Joins, LineSet};
use super::{angle, lines};

/// Line ends further apart than this many spacings along the boundary are not joined.
const LONGEST_JOIN: f64 = 12.0;

/// The outermost lines keep this far from the patch's extreme points, where they would vanish.
const INSIDE_MM: f64 = 0.002;

/// The same without beads of fitting width in the remainder, in spacings: an edge along the lines is never quite
/// straight, and the outermost line should lie along all of it.
const INSIDE: f64 = 0.08;

/// Lines that are so much closer or wider than usual, as a share of their distance, keep half of their own distance from the
/// walls.
const UNEVEN: f64 = 0.005;

/// Parts of a solid zone narrower than this many spacings are filled along their boundary: lines across would consist
/// of ends.
const NARROW: f64 = 3.5;

/// Parts that are nowhere narrower than this many spacings are left with the wide ones: where beads along the boundary
/// meet parallel lines they leave voids.
const NECK: f64 = 2.75;

/// So are those smaller than this many squared spacings: corners.
const CORNER: f64 = 4.0;

/// Splits a solid zone into parts wide enough for parallel lines, and the rest.
pub fn split_narrow(zone: &Region, spacing_mm: f64) -> (Region, Region) {
    let core = geometry::core(zone, NARROW / 2.0 * spacing_mm);
    if core.region.is_empty() {
        return (core.region, zone.clone());
    }
    let in_cores: Vec<Point> = core.region.polygons().iter().map(|part| part.outer[0]).collect();
    let boxes = Boxes::new(in_cores.iter().map(|&p| Bounds::spanned(p, p)));
    let is_wide = |polygon: &Polygon| {
        boxes.touching(&polygon.bounds()).into_iter().any(|core| polygon.contains(in_cores[core]))
    };
    let (wide, small): (Vec<_>, Vec<_>) = zone.polygons().iter().cloned().partition(is_wide);
    let wide = Region::disjoint(wide);
    let mut narrow = geometry::narrower(&wide, &core, NARROW / 2.0 * spacing_mm, spacing_mm / 2.0);
    narrow.retain(|polygon| polygon.area_mm2() >= CORNER * spacing_mm * spacing_mm);
    if !narrow.is_empty() {
        let core = geometry::core(&wide, NECK / 2.0 * spacing_mm);
        let necks = geometry::narrower(&wide, &core, NECK / 2.0 * spacing_mm, spacing_mm / 2.0);
        narrow.retain(|polygon| !geometry::intersection(&Region::from(polygon.clone()), &necks).is_empty());
    }
    let wide = if narrow.is_empty() { wide } else { geometry::remainder(&wide, &narrow) };
    narrow.add_disjoint(small);
    (wide, narrow)
}

/// Lines laid side by side into one patch.
pub struct SolidPatch {
    /// Their spacing.
    pub spacing_mm: f64,
    /// Their direction.
    pub direction: Direction,
    /// The lines, each with the index of the first of the parallel lines that it consists of.
    pub lines: Vec<(u32, Line)>,
}

/// How a region is filled solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolidSpec {
    /// Distance of the lines.
    pub spacing_mm: f64,
    /// How far free ends reach beyond half a spacing inside the boundary.
    pub reach_mm: f64,
    /// How far ends at sharp turns reach, as a multiple of that.
    pub turn_reach: f64,
    /// Direction of the first layer's lines; they turn by 90° from layer to layer.
    pub angle_rad: f64,
    /// Index of the layer, from 0.
    pub layer: usize,
    /// Whether lines may run in another direction where they have fewer ends.
    pub fit_angle: bool,
    /// Whether line ends are joined along the boundary; else each line is by itself.
    pub joined: bool,
    /// Whether beads of fitting width fill the remainder where the boundary runs along the lines.
    pub capped: bool,
    /// Smallest and largest coordinate across the lines that they are fitted to, if not those of the patch.
    pub fit_mm: Option<(f64, f64)>,
}

/// Fills each polygon of a region with lines a spacing apart or slightly closer or wider: the extent across
/// the lines is divided evenly. Joins run half a spacing inside the boundary.
pub fn fill(region: &Region, spec: &SolidSpec) -> Vec<SolidPatch> {
    let SolidSpec { spacing_mm, reach_mm, .. } = *spec;
    let usual_rad = turned(spec.angle_rad, spec.layer);
    let inner = geometry::offset(region, -spacing_mm / 2.0);
    inner
        .into_polygons()
        .into_iter()
        .map(|polygon| {
            let mut patch = Region::from(polygon);
            let angle_rad = if spec.fit_angle { angle::fewest_turns(&patch, usual_rad) } else { usual_rad };
            let direction = Direction::of(angle_rad);
            let (mut low_mm, mut high_mm) = direction.extent_mm(patch.rings().flatten());
            let inwards_mm = (fitted(high_mm - low_mm + spacing_mm, spacing_mm) - spacing_mm) / 2.0;
            if spec.fit_mm.is_none() && inwards_mm.abs() > UNEVEN * spacing_mm {
                patch = geometry::offset(&patch, -inwards_mm);
                (low_mm, high_mm) = direction.extent_mm(patch.rings().flatten());
            }
            if let Some((from_mm, to_mm)) = spec.fit_mm {
                (low_mm, high_mm) =
                    (low_mm.max(from_mm + spacing_mm / 2.0), high_mm.min(to_mm - spacing_mm / 2.0));
            }
            let inside_mm = if spec.capped { INSIDE_MM } else { INSIDE * spacing_mm };
            let width_mm = (high_mm - low_mm - 2.0 * inside_mm).max(0.0);
            let gaps = (width_mm / spacing_mm).round();
            let (fitted_mm, phase_mm) = if gaps >= 1.0 {
                (width_mm / gaps, low_mm + inside_mm)
            } else {
                (spacing_mm, (low_mm + high_mm) / 2.0)
            };
            let joins = Joins {
                longest_mm: if spec.joined { LONGEST_JOIN * spacing_mm } else { 0.0 },
                reach_mm,
                turn_reach_mm: spec.turn_reach * reach_mm,
                anchor_mm: 0.0,
                hatch: spec.capped.then(|| LineSet::new(angle_rad, fitted_mm, phase_mm)),
            };
            let first_of = |line: &Line| {
                let (first_mm, _) = direction.extent_mm(&line.points);
                ((first_mm - phase_mm) / fitted_mm).round().max(0.0) as u32
            };
            let lines = lines::parallel(&patch, angle_rad, fitted_mm, phase_mm, &joins);
            let lines = lines.into_iter().map(|line| (first_of(&line), line)).collect();
            SolidPatch { spacing_mm: fitted_mm, direction, lines }
        })
        .collect()
}

/// The distance at which lines fill a width evenly.
fn fitted(width_mm: f64, spacing_mm: f64) -> f64 {
    width_mm / (width_mm / spacing_mm).round().max(1.0)
}

/// Ironing: lines close to each other, at 45° to those of the surface beneath.
pub fn iron(region: &Region, spacing_mm: f64, angle_rad: f64, layer: usize) -> Vec<Line> {
    let angle_rad = turned(angle_rad, layer) + FRAC_PI_4;
    let joins = Joins { longest_mm: LONGEST_JOIN * spacing_mm, ..Joins::default() };
    lines::parallel(region, angle_rad, spacing_mm, 0.0, &joins)
}

/// Direction of the solid lines of a layer.
pub fn turned(angle_rad: f64, layer: usize) -> f64 {
    angle_rad + if layer % 2 == 1 { FRAC_PI_2 } else { 0.0 }
}
