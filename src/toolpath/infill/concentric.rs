//! Loops parallel to the outline.

use geometry::Region;

use super::super::bead::Line;
use super::pattern::FillPattern;
use super::spec::FillSpec;

/// See the module.
#[derive(Debug)]
pub struct Concentric;

impl FillPattern for Concentric {
    fn fill(&self, region: &Region, spec: &FillSpec) -> Vec<Line> {
        let mut loops = Vec::new();
        // The walls around are the pattern's outermost loop, half a distance outside the region on average.
        let mut rest = geometry::offset(region, -spec.line_distance_mm / 2.0);
        while !rest.is_empty() {
            loops.extend(rest.rings().map(|ring| Line::nominal(ring.clone(), true)));
            rest = geometry::offset(&rest, -spec.line_distance_mm);
        }
        loops
    }
}
