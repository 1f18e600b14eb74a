//! Three sets of lines at 60° in each layer, of which no three meet in a point: hexagons between triangles (kagome).

use std::f64::consts::FRAC_PI_3;

use super::pattern::FillPattern;

use super::spec::{FillSpec, LineSet};

use super::lines;

/// See the module.
#[derive(Debug)]
pub struct TriHexagon;

impl FillPattern for TriHexagon {
    fn sets(&self, spec: &FillSpec) -> Vec<LineSet> {
        // The middle set runs midway between the points where the other two meet.
        let half_mm = 1.5 * spec.line_distance_mm;
        lines::sets(spec, FRAC_PI_3, &[0.0, half_mm, 0.0])
    }
}
