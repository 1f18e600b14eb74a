//! Sparse infill of exactly the requested density.

use geometry::{Region, polyline_length_mm, ring_length_mm};

use super::super::bead::Line;
use super::pattern::FillPattern;
use super::spec::{FillSpec, Joins};

/// Densities above this are solid.
pub const SOLID_DENSITY: f64 = 0.995;

/// A layer that a pattern is calibrated on.
#[derive(Clone, Debug)]
pub struct SparseSample {
    /// Where the pattern's lines may run.
    pub area: Region,
    /// Area that is to be filled to the density, square millimetres.
    pub area_mm2: f64,
    /// The layer; its line distance is not read.
    pub spec: FillSpec,
}

/// Rounds of correction. Each leaves about a tenth of the error, until whole lines come and go.
const ROUNDS: usize = 4;

/// Share of the density that is near enough.
const EXACT: f64 = 0.002;

/// The same for a single area, whose lines may else be laid otherwise.
const NEAR_ENOUGH: f64 = 0.01;

/// Of this many lines at least one is laid in narrow areas.
const SPARSEST: u32 = 5;

/// Joined lines may hold this many times what they should before they are left apart: each line apart costs a travel, and
/// that takes longer than a few millimetres of bead.
const MOST_SHARE: f64 = 1.5;

/// What whole lines cannot make up, the bead's cross-section does, within this share.
const MOST_FLOW: f64 = 0.2;

/// The factor of the beads' cross-section at which lines laid into an area have the requested density, as far as
/// a few percent of flow can make up for whole lines that come and go. `solid_mm` is the length of lines that would
/// fill the area.
pub fn flow(lines: &[Line], solid_mm: f64, density: f64) -> f64 {
    let length_mm: f64 = lines.iter().map(line_length_mm).sum();
    if length_mm > 0.0 {
        (solid_mm * density / length_mm).clamp(1.0 - MOST_FLOW, 1.0 + MOST_FLOW)
    } else {
        1.0
    }
}

/// The share of the density that lines have, their [`flow`] fitted: 1 where that can make up for everything.
fn reached(lines: &[Line], solid_mm: f64, density: f64) -> f64 {
    let length_mm: f64 = lines.iter().map(line_length_mm).sum();
    length_mm * flow(lines, solid_mm, density) / (solid_mm * density)
}

/// A pattern's lines in an area that needs `solid_mm` of line to be solid.
///
/// In narrow areas the connections along the walls outweigh the lines themselves. There only every second, third … line is
/// laid, as few as hold enough, so that they still join to few long beads; where that is far too much nevertheless,
/// lines stay apart. Those of a pattern that does not [nest](FillPattern::nests) are laid apart at once.
pub fn lay(
    pattern: &dyn FillPattern,
    area: &Region,
    spec: &FillSpec,
    solid_mm: f64,
    density: f64,
) -> Vec<Line> {
    let share = |lines: &[Line]| reached(lines, solid_mm, density);
    let enough = 1.0 - NEAR_ENOUGH..=1.0 + NEAR_ENOUGH;
    let mut joined = pattern.fill(area, spec);
    let sparsest = if pattern.nests() { SPARSEST } else { 1 };
    for n in 2..=sparsest {
        if share(&joined) <= *enough.end() {
            break;
        }
        let fewer = pattern.fill(area, &spec.sparser(n));
        if share(&fewer) < *enough.start() {
            break;
        }
        joined = fewer;
    }
    let most = if pattern.nests() { MOST_SHARE } else { *enough.end() };
    if (*enough.start()..=most).contains(&share(&joined)) {
        return joined;
    }
    let apart = pattern.fill(area, &spec.apart());
    let off = |lines: &[Line]| (share(lines) - 1.0).abs();
    if off(&apart) < off(&joined) { apart } else { joined }
}

/// The mean distance between lines, in millimetres, at which a pattern, with all joins along the walls, fills its
/// share of the regions.
///
/// What a pattern deposits differs from spacing over distance: line ends are joined along the walls, curves
/// are longer than straight lines, and small regions hold more or fewer lines than their area says. So the
/// pattern is laid into sample layers and the distance corrected by what came out. The longest join is `join`
/// line distances.
pub fn calibrate(
    pattern: &dyn FillPattern,
    samples: &[SparseSample],
    spacing_mm: f64,
    density: f64,
    join: f64,
) -> f64 {
    let nominal_mm = spacing_mm / density;
    let area_mm2: f64 = samples.iter().map(|s| s.area_mm2).sum();
    let mut best_mm = nominal_mm;
    let mut best_error = f64::INFINITY;
    let mut distance_mm = nominal_mm;
    for _ in 0..ROUNDS {
        let length_mm: f64 = samples
            .iter()
            .map(|sample| {
                let joins = Joins { longest_mm: join * distance_mm, ..sample.spec.joins };
                let spec = FillSpec { line_distance_mm: distance_mm, joins, ..sample.spec };
                pattern.fill(&sample.area, &spec).iter().map(line_length_mm).sum::<f64>()
            })
            .sum();
        if length_mm <= 0.0 || area_mm2 <= 0.0 {
            break;
        }
        let measured = length_mm * spacing_mm / area_mm2 / density;
        if (measured - 1.0).abs() < best_error {
            best_error = (measured - 1.0).abs();
            best_mm = distance_mm;
        }
        if best_error < EXACT {
            break;
        }
        distance_mm = (distance_mm * measured).clamp(0.5 * nominal_mm, 2.0 * nominal_mm);
    }
    best_mm
}

fn line_length_mm(line: &Line) -> f64 {
    if line.closed { ring_length_mm(&line.points) } else { polyline_length_mm(&line.points) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::toolpath::infill::rectilinear::Rectilinear;
    use geometry::{Point, Polygon};

    #[test]
    fn in_a_narrow_area_fewer_lines_join_to_one_bead_of_the_same_density() {
        let corners = [(0.0, 0.0), (40.0, 0.0), (40.0, 3.0), (0.0, 3.0)];
        let outer = corners.map(|(x, y)| Point::from_mm(x, y)).to_vec();
        let area = Region::from(Polygon { outer, holes: Vec::new() });
        let (distance_mm, density) = (2.0, 0.2);
        let spec = FillSpec {
            line_distance_mm: distance_mm,
            spacing_mm: distance_mm * density,
            angle_rad: std::f64::consts::FRAC_PI_4,
            layer: 0,
            z_mm: 0.1,
            joins: Joins { longest_mm: 2.5 * distance_mm, ..Joins::default() },
        };
        let solid_mm = area.area_mm2() / (distance_mm * density);
        let lines = lay(&Rectilinear, &area, &spec, solid_mm, density);
        assert!(lines.len() <= 2, "{}", lines.len());
        let share = reached(&lines, solid_mm, density);
        assert!((0.99..=1.2).contains(&share), "{share}");
    }
}
