//! Sparse infill of exactly the density asked for.

use crate::geom::{Region, polyline_length_mm, ring_length_mm};

use super::{FillLine, FillPattern, FillSpec};

/// Rounds of correction; each leaves about a tenth of the error.
const ROUNDS: usize = 3;

/// The distance between lines at which a pattern, with all joins along the walls, fills its share of the regions.
///
/// What a pattern deposits differs from spacing over distance: line ends are joined along the walls, curves
/// are longer than straight lines, and small regions hold more or fewer lines than their area says. So the
/// pattern is laid into sample layers and the distance corrected by what came out. `samples` are regions with
/// the area that counts as theirs (square millimetres) and their `FillSpec`, whose distance is ignored.
pub fn calibrated_line_distance_mm(
    pattern: &dyn FillPattern,
    samples: &[(Region, f64, FillSpec)],
    spacing_mm: f64,
    density: f64,
) -> f64 {
    let nominal_mm = spacing_mm / density;
    let area_mm2: f64 = samples.iter().map(|s| s.1).sum();
    let mut distance_mm = nominal_mm;
    for _ in 0..ROUNDS {
        let length_mm: f64 = samples
            .iter()
            .map(|(region, _, spec)| {
                let spec = FillSpec { line_distance_mm: distance_mm, ..*spec };
                pattern.fill(region, &spec).iter().map(line_length_mm).sum::<f64>()
            })
            .sum();
        if length_mm <= 0.0 || area_mm2 <= 0.0 {
            break;
        }
        let measured = length_mm * spacing_mm / area_mm2;
        distance_mm = (distance_mm * measured / density).clamp(0.5 * nominal_mm, 2.0 * nominal_mm);
    }
    distance_mm
}

fn line_length_mm(line: &FillLine) -> f64 {
    if line.closed { ring_length_mm(&line.points) } else { polyline_length_mm(&line.points) }
}
