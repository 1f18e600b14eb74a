//! Cells after the truncated octahedron: waves that swell with the height from straight lines until they meet, and back;
//! then the same at right angles.
//!
//! The sloping parts of the waves are the upright square faces of the cells, seen from above at 45° to the lines; the
//! level parts are their hexagonal faces, which lean by 35.3° from the vertical. Half of those faces are left out at each
//! height: the other direction has its turn above.

use std::f64::consts::{FRAC_PI_2, SQRT_2};

use geometry::Region;

use super::super::bead::Line;
use super::pattern::FillPattern;
use super::spec::FillSpec;
use super::waves::{self, Frame};

/// Distance of the waves in mean line distances: on average over the height they are (1 + √2)/2 times as long as straight
/// lines.
const ROW: f64 = (1.0 + SQRT_2) / 2.0;

/// See the module.
#[derive(Debug)]
pub struct Honeycomb3d;

impl FillPattern for Honeycomb3d {
    fn fill(&self, region: &Region, spec: &FillSpec) -> Vec<Line> {
        let row_mm = ROW * spec.line_distance_mm;
        let cell_mm = SQRT_2 * row_mm;
        let (cell, up_mm) = ((spec.z_mm / cell_mm).floor(), spec.z_mm.rem_euclid(cell_mm));
        let across = cell.rem_euclid(2.0) >= 1.0;
        let frame = Frame::new(spec.angle_rad + if across { FRAC_PI_2 } else { 0.0 });
        let Some([low, high]) = frame.extent_mm(region) else {
            return Vec::new();
        };
        // Waves that meet lie a bead apart.
        let most_mm = ((row_mm - spec.spacing_mm) / 2.0).max(0.0);
        let swing_mm = (up_mm.min(cell_mm - up_mm) / SQRT_2).min(most_mm);
        let nodes = waves::steps(low[0], high[0], row_mm);
        let curves = waves::steps(low[1], high[1], row_mm).map(|row| {
            let slopes = nodes.clone().flat_map(|node| {
                let (u, v) = (node as f64 * row_mm, row as f64 * row_mm);
                let rise_mm = if (node + row) % 2 == 0 { swing_mm } else { -swing_mm };
                [[u - swing_mm, v - rise_mm], [u + swing_mm, v + rise_mm]]
            });
            slopes.map(|at| frame.point(at)).collect()
        });
        waves::lay(region, curves, spec)
    }
}
