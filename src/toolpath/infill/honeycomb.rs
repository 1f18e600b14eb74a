//! Hexagons with upright walls, turned by 60° from layer to layer.
//!
//! Each line runs along one side of a row of hexagons, so that a third of the sides is drawn twice, beads beside each
//! other; which third it is changes with the layer.

use std::f64::consts::FRAC_PI_3;

use geometry::Region;

use super::super::bead::Line;
use super::pattern::FillPattern;
use super::spec::FillSpec;
use super::waves::{self, Frame};

/// Side of a hexagon in mean line distances: four sides are drawn in each hexagon's area of 3√3/2 squared sides.
const SIDE: f64 = 1.539_600_717_839_002;

/// Height of a triangle with sides of 1.
const TRIANGLE: f64 = 0.866_025_403_784_438_6;

/// See the module.
#[derive(Debug)]
pub struct Honeycomb;

impl FillPattern for Honeycomb {
    fn fill(&self, region: &Region, spec: &FillSpec) -> Vec<Line> {
        let frame = Frame::new(spec.angle_rad);
        let Some([low, high]) = frame.extent_mm(region) else {
            return Vec::new();
        };
        let side_mm = SIDE * spec.line_distance_mm;
        let row_mm = TRIANGLE * side_mm;
        // Sides that two rows share hold a bead of each.
        let swing_mm = (row_mm - spec.spacing_mm).max(0.0) / 2.0;
        let half_mm = 1.5 * side_mm;
        let halves = waves::steps(low[0], high[0], half_mm);
        let curves = waves::steps(low[1], high[1], row_mm).map(|row| {
            let flats = halves.clone().flat_map(|half| {
                let v = row as f64 * row_mm + if (half + row) % 2 == 0 { swing_mm } else { -swing_mm };
                let u = half as f64 * half_mm;
                [[u, v], [u + side_mm, v]]
            });
            flats.map(|at| frame.point(at)).collect()
        });
        waves::lay(region, curves, spec)
    }

    fn rotation_rad(&self, layer: usize) -> f64 {
        (layer % 3) as f64 * FRAC_PI_3
    }
}
