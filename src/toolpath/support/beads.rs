//! The beads of one layer of support.

use std::f64::consts::FRAC_PI_2;

use super::columns::Cells;
use super::trace::trace;
use crate::toolpath::infill::{Joins, lines};
use crate::toolpath::options::{SupportPattern, SupportSettings, SupportStyle};
use crate::toolpath::{Path, Phase, Role, Width, bead};
use geometry::{Direction, HatchSegment, Point, Polygon, Region};

/// Lines of support shorter than this hold nothing.
pub(super) const SHORTEST_MM: f64 = 0.5;

/// How far lines reach into the loop around them, as a share of the width.
const OVERLAP: f64 = 0.25;

/// Columns narrower than a disc of this diameter need no lines inside: the interface spans them.
const WIDE_MM: f64 = 5.0;

/// Ends of lines are joined along the loop up to this many line distances.
const LONGEST_JOIN: f64 = 2.0;

/// How many chains are looked at for one that a line may continue.
const RECENT: usize = 64;

/// On the bed the lines lie closer by this factor, to stick.
const DENSER_ON_BED: f64 = 2.0;

/// Outlines of one layer of support.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outlines {
    /// Everywhere that support stands.
    pub all: Region,
    /// Where it is dense.
    pub interface: Region,
}

impl Outlines {
    /// Of cells.
    pub fn of(cells: &Cells) -> Self {
        Self { all: trace(&cells.all), interface: trace(&cells.interface) }
    }
}

/// A layer that support is laid into.
#[derive(Clone, Copy, Debug)]
pub struct BeadSpec<'a> {
    /// The part, which no support touches, unless the outlines are clear of it.
    pub part: &'a Region,
    /// Height of the beads.
    pub height_mm: f64,
    /// Height of an ordinary layer: it says how far apart the tracks are on all.
    pub usual_height_mm: f64,
    /// Whether it lies on the bed.
    pub on_bed: bool,
}

/// The beads: a loop around each part of the region, parallel lines inside.
///
/// Lines lie on tracks that are the same on all layers, so each stands on the one below. Those of the interface
/// cross them and are extended to the next track or loop, so that none begins in mid-air.
pub fn lay(outlines: &Outlines, layer: &BeadSpec<'_>, settings: &SupportSettings) -> Vec<Path> {
    if outlines.all.is_empty() {
        return Vec::new();
    }
    let width_mm = settings.width.0;
    let area = geometry::difference(&outlines.all, &geometry::offset(layer.part, settings.xy_gap.0));
    let mut paths = Vec::new();
    let mut push = |role, phase, closed, points: Vec<Point>| {
        let width = Width::Constant(width_mm);
        paths.push(Path {
            role,
            closed,
            points,
            width,
            height_mm: layer.height_mm,
            island: None,
            phase,
            tool: None,
        });
    };
    let frame = geometry::offset(&area, -width_mm / 2.0);
    for ring in frame.rings().filter(|ring| ring.len() >= 3 && geometry::ring_length_mm(ring) >= SHORTEST_MM)
    {
        push(Role::Support, Phase::Support, true, ring.clone());
    }
    let inside = geometry::offset(&frame, -width_mm * (1.0 - OVERLAP));
    let spacing_mm = bead::spacing_mm(width_mm, layer.usual_height_mm);
    let denser = if layer.on_bed { DENSER_ON_BED } else { 1.0 };
    let sets = match settings.pattern {
        SupportPattern::Rectilinear => 1,
        SupportPattern::Grid => 2,
    };
    let apart_mm = f64::from(sets) * spacing_mm / settings.density.0;
    let dense =
        if layer.on_bed { Region::default() } else { geometry::intersection(&inside, &outlines.interface) };
    let mut wide = wide_parts(&inside);
    if settings.style == SupportStyle::Tree {
        // Branches shift from layer to layer: under a head there need be no track to reach for.
        wide.retain(|polygon| geometry::intersection(&Region::from(polygon.clone()), &dense).is_empty());
    }
    let body = geometry::difference(&wide, &dense);
    let angle_rad = settings.line_angle.to_radians();
    if settings.density.0 > 0.0 {
        for set in 0..sets {
            let turned_rad = angle_rad + f64::from(set) * FRAC_PI_2;
            let distance_mm = apart_mm / denser;
            let joins = Joins { longest_mm: LONGEST_JOIN * distance_mm, ..Joins::default() };
            for line in lines::parallel(&body, turned_rad, distance_mm, 0.0, &joins) {
                if geometry::polyline_length_mm(&line.points) >= SHORTEST_MM {
                    push(Role::Support, Phase::Support, line.closed, line.points);
                }
            }
        }
    }
    if settings.interface_density.0 > 0.0 && !dense.is_empty() {
        let across_rad = angle_rad + FRAC_PI_2;
        let tracks =
            |region| geometry::scan_lines(region, across_rad, spacing_mm / settings.interface_density.0, 0.0);
        let narrow =
            Region::disjoint(inside.polygons().iter().filter(|p| !wide.polygons().contains(p)).cloned());
        for (part, apart_mm) in [(&wide, apart_mm), (&narrow, f64::INFINITY)] {
            let lines = extended(&tracks(&dense), &tracks(part), across_rad, apart_mm);
            for points in joined(lines, part, LONGEST_JOIN * spacing_mm / settings.interface_density.0) {
                push(Role::SupportInterface, Phase::SupportInterface, false, points);
            }
        }
    }
    paths
}

/// The polygons whose mean width is at least that of a disc of [`WIDE_MM`]: twice the area over the boundary.
fn wide_parts(region: &Region) -> Region {
    let is_wide = |polygon: &&Polygon| {
        let around_mm: f64 = polygon.rings().map(|ring| geometry::ring_length_mm(ring)).sum();
        2.0 * polygon.area_mm2() >= WIDE_MM / 2.0 * around_mm
    };
    Region::disjoint(region.polygons().iter().filter(is_wide).cloned())
}

/// Lines with both ends moved outwards to a multiple of `apart_mm`, where the body's tracks are, or to the end of the
/// area's line that they are part of. Lines that meet become one. Returns them with the index of their track.
fn extended(
    lines: &[HatchSegment],
    area: &[HatchSegment],
    angle_rad: f64,
    apart_mm: f64,
) -> Vec<(i64, [Point; 2])> {
    let direction = Direction::of(angle_rad);
    let along = |p: Point| direction.along_mm(p);
    let mut result = Vec::new();
    for parts in lines.chunk_by(|a, b| a.line == b.line) {
        let line = parts[0].line;
        let first = area.partition_point(|part| part.line < line);
        for HatchSegment { ends: [start, end], .. } in
            area[first..].iter().take_while(|part| part.line == line)
        {
            let (low, high) = (along(start.point), along(end.point));
            let at = |t: f64| direction.from(start.point, t - low, 0.0);
            let mut open: Option<[f64; 2]> = None;
            for HatchSegment { ends: [a, b], .. } in parts {
                let (a, b) = (along(a.point), along(b.point));
                if b <= low || a >= high {
                    continue;
                }
                let to_track = |t: f64, outward: fn(f64) -> f64, end: f64| {
                    if apart_mm.is_finite() { outward(t / apart_mm) * apart_mm } else { end }
                };
                let from = to_track(a, f64::floor, low).max(low);
                let to = to_track(b, f64::ceil, high).min(high);
                match &mut open {
                    Some(open) if from <= open[1] => open[1] = open[1].max(to),
                    _ => result.extend(open.replace([from, to]).map(|[f, t]| (line, [at(f), at(t)]))),
                }
            }
            result.extend(open.map(|[f, t]| (line, [at(f), at(t)])));
        }
    }
    result
}

/// Lines of neighbouring tracks joined to and fro where their ends are near and the straight line between is in the area.
fn joined(lines: Vec<(i64, [Point; 2])>, area: &Region, longest_mm: f64) -> Vec<Vec<Point>> {
    let mut chains: Vec<(i64, Vec<Point>)> = Vec::new();
    for (track, [a, b]) in lines.into_iter().filter(|(_, [a, b])| a.distance_mm(*b) >= SHORTEST_MM) {
        // Chains that may continue are among the last.
        let near = |end: &Point| {
            let to = if a.distance_mm(*end) <= b.distance_mm(*end) { a } else { b };
            let middle = Point::new((to.x + end.x) / 2, (to.y + end.y) / 2);
            to.distance_mm(*end) <= longest_mm && area.contains(middle)
        };
        let recent = chains.iter_mut().rev().take(RECENT);
        let chain =
            recent.filter(|(last, _)| *last + 1 == track).find(|(_, path)| path.last().is_some_and(near));
        let Some((last, path)) = chain else {
            chains.push((track, vec![a, b]));
            continue;
        };
        let a_first = path.last().is_some_and(|end| a.distance_mm(*end) <= b.distance_mm(*end));
        path.extend(if a_first { [a, b] } else { [b, a] });
        *last = track;
    }
    chains.into_iter().map(|(_, path)| path).collect()
}
