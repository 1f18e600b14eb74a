//! Branches that hold up roofs inside of the part and nothing else.
//!
//! Under every roof branches end so close to each other that no place of it is further than half the line distance from a
//! branch or a wall. From layer to layer downwards they grow shorter and straighter, no faster than a wall may lean, until
//! they vanish in the walls: trees that stand on the walls' inner sides. Places that nothing holds are taken in order of
//! their distance from the walls, and each is joined to the nearest branch or wall.
//!
//! T. Tricard, F. Claux, S. Lefebvre, "Ribbed support vaults for 3D printing of hollowed objects", Computer Graphics Forum
//! 39 (2020), DOI 10.1111/cgf.13750.

use crate::geom::{self, Clipper, Point, Region, Ring};

use super::super::bead::Line;
use super::connect::{Chord, connect};
use super::trees::Forest;
use super::{FillPattern, FillSpec};

/// Tangent of how far branches lean: 40° from the vertical.
const LEAN: f64 = 0.84;

/// Roofs are looked at in points this far apart, in reaches of a branch.
const SAMPLE: f64 = 0.5;

/// Points nearer to each other are not worth looking at, in millimetres.
const FINEST_SAMPLE_MM: f64 = 0.3;

/// Roofs smaller than this many squared reaches need no branch.
const SMALLEST_ROOF: f64 = 0.5;

/// What lightning has to know of a layer.
#[derive(Clone, Debug, Default)]
pub struct Hollow {
    /// What lies inside of the middle of the walls.
    pub ground: Region,
    /// What sparse infill would fill.
    pub sparse: Region,
    /// Height of the layer in millimetres.
    pub height_mm: f64,
}

/// See the module. The default knows of no roof and has no branch.
#[derive(Debug, Default)]
pub struct Lightning {
    /// The strokes of each layer.
    layers: Vec<Vec<Ring>>,
}

impl Lightning {
    /// Grows branches under all roofs, from the top down: `hollows` are the layers from the bed up. What the layer above
    /// does not fill sparsely is a roof. O(layers · branches).
    pub fn new(hollows: &[Hollow], line_distance_mm: f64) -> Self {
        let reach_mm = line_distance_mm / 2.0;
        let mut layers = vec![Vec::new(); hollows.len()];
        let mut forest = Forest::default();
        for layer in (0..hollows.len()).rev() {
            let hollow = &hollows[layer];
            let above = hollows.get(layer + 1).map_or(Region::EMPTY, |above| &above.sparse);
            forest.shrink(LEAN * hollow.height_mm);
            forest.ground(&hollow.ground);
            let mut roof = geom::difference(&hollow.sparse, above);
            roof.polygons.retain(|polygon| polygon.area_mm2() >= SMALLEST_ROOF * reach_mm * reach_mm);
            forest.hold(&samples(&roof, reach_mm), &hollow.ground, reach_mm);
            layers[layer] = forest.strokes();
        }
        Self { layers }
    }
}

impl FillPattern for Lightning {
    fn fill(&self, region: &Region, spec: &FillSpec) -> Vec<Line> {
        let clipper = Clipper::new(region);
        let strokes = self.layers.get(spec.layer).into_iter().flatten();
        let chords = (0..).zip(strokes).flat_map(|(line, stroke)| {
            let pieces = clipper.clip(stroke);
            pieces.into_iter().map(move |piece| Chord { points: piece.points, ends: piece.ends, line })
        });
        connect(region, chords.collect(), &spec.apart().joins)
    }

    fn is_even(&self) -> bool {
        false
    }
}

/// Points all over a region.
fn samples(region: &Region, reach_mm: f64) -> Vec<Point> {
    let step_mm = (SAMPLE * reach_mm).max(FINEST_SAMPLE_MM);
    let lines = geom::scan_lines(region, 0.0, step_mm, 0.0);
    let segments = lines.iter().flat_map(|line| &line.segments);
    segments
        .flat_map(|[a, b]| {
            let (from, to) = (a.point.mm()[0], b.point.mm()[0]);
            let columns = (from / step_mm).ceil() as i64..=(to / step_mm).floor() as i64;
            columns.map(|column| Point::new(geom::to_units(column as f64 * step_mm), a.point.y))
        })
        .collect()
}
