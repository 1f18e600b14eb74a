//! Cubes that stand on a corner: three sets of lines at 60° in each layer, which wander with the height.
//!
//! A plane of a cube whose space diagonal is upright leans by 35.3° from the vertical, so that its section moves by
//! 1/√2 of the height. The horizontal parts of the three normals are 120° apart; the second set, 60° from the first, runs
//! along the third plane seen from behind and moves in the opposite direction.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_3};

use super::pattern::FillPattern;

use super::spec::{FillSpec, LineSet};

use super::lines;

/// See the module.
#[derive(Debug)]
pub struct Cubic;

impl FillPattern for Cubic {
    fn sets(&self, spec: &FillSpec) -> Vec<LineSet> {
        let moved_mm = spec.z_mm * FRAC_1_SQRT_2;
        lines::sets(spec, FRAC_PI_3, &[-moved_mm, moved_mm, -moved_mm])
    }

    fn nests(&self) -> bool {
        true
    }
}
