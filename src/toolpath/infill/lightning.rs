//! Lightning infill: branches that support top surfaces from inside, and nothing else.
//!
//! Under every roof branches end so close to each other that no place of it is further than half the line distance from a
//! branch or a wall. From layer to layer downwards they grow shorter and straighter, no faster than a wall may lean, until
//! they vanish in the walls: trees that stand on the walls' inner sides. Places that nothing holds are taken in order of
//! their distance from the walls, and each is joined to the nearest branch or wall.
//!
//! T. Tricard, F. Claux, S. Lefebvre, "Ribbed support vaults for 3D printing of hollowed objects", Computer Graphics Forum
//! 39 (2020), DOI 10.1111/cgf.13750.

use geometry::{Clipper, HatchSegment, Point, Region, Ring};

use super::super::bead::Line;
use super::connect::connect;
use super::pattern::FillPattern;
use super::spec::Chord;
use super::spec::FillSpec;
use super::trees::Forest;

/// Tangent of how far branches lean: 40° from the vertical.
const LEAN: f64 = 0.84;

/// Roofs are looked at in points this far apart, in reaches of a branch.
const SAMPLE: f64 = 0.5;

/// Points nearer to each other are not worth looking at, in millimetres.
const FINEST_SAMPLE_MM: f64 = 0.3;

/// Roofs smaller than this many squared reaches need no branch.
const SMALLEST_ROOF: f64 = 0.5;

/// What lightning infill needs of a layer.
#[derive(Clone, Debug, Default)]
pub struct LightningLayer {
    /// What lies inside the middle of the walls.
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
    pub fn new(hollows: &[LightningLayer], line_distance_mm: f64) -> Self {
        let reach_mm = line_distance_mm / 2.0;
        let mut layers = vec![Vec::new(); hollows.len()];
        let mut forest = Forest::default();
        for layer in (0..hollows.len()).rev() {
            let hollow = &hollows[layer];
            let above = hollows.get(layer + 1).map_or(Region::EMPTY, |above| &above.sparse);
            forest.shrink(LEAN * hollow.height_mm);
            forest.ground(&hollow.ground);
            let mut roof = geometry::difference(&hollow.sparse, above);
            roof.retain(|polygon| polygon.area_mm2() >= SMALLEST_ROOF * reach_mm * reach_mm);
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
        let mut lines = connect(region, chords.collect(), &spec.apart().joins);
        // Twigs that the bead they come off is nearly as wide as hold nothing.
        lines.retain(|line| geometry::polyline_length_mm(&line.points) >= spec.spacing_mm);
        lines
    }

    fn is_uniform(&self) -> bool {
        false
    }
}

/// Points all over a region.
fn samples(region: &Region, reach_mm: f64) -> Vec<Point> {
    let step_mm = (SAMPLE * reach_mm).max(FINEST_SAMPLE_MM);
    let segments = geometry::scan_lines(region, 0.0, step_mm, 0.0);
    segments
        .iter()
        .flat_map(|HatchSegment { ends: [a, b], .. }| {
            let (from, to) = (a.point.mm()[0], b.point.mm()[0]);
            let columns = (from / step_mm).ceil() as i64..=(to / step_mm).floor() as i64;
            columns.map(|column| Point::new(geometry::to_units(column as f64 * step_mm), a.point.y))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::Joins;
    use super::*;
    use geometry::{Polygon, to_segment_mm};

    const HEIGHT_MM: f64 = 0.2;

    fn square(from: f64, to: f64) -> Region {
        let corners = [(from, from), (to, from), (to, to), (from, to)];
        let outer = corners.map(|(x, y)| Point::from_mm(x, y)).to_vec();
        Region::from(Polygon { outer, holes: Vec::new() })
    }

    /// The strokes of each layer of a box with a roof over its right half, and one over all at the top.
    fn grown() -> (Vec<Vec<Line>>, Region) {
        let (ground, all) = (square(0.0, 40.0), square(0.4, 39.6));
        let layer = |i: usize| {
            let sparse = if i < 60 { all.clone() } else { square(0.4, 20.0) };
            LightningLayer { ground: ground.clone(), sparse, height_mm: HEIGHT_MM }
        };
        let lightning = Lightning::new(&(0..100).map(layer).collect::<Vec<_>>(), 4.0);
        let fill = |layer| {
            let joins = Joins::default();
            let (line_distance_mm, spacing_mm, angle_rad, z_mm) = (4.0, 0.0, 0.0, 0.0);
            lightning.fill(&ground, &FillSpec { line_distance_mm, spacing_mm, angle_rad, layer, z_mm, joins })
        };
        ((0..100).map(fill).collect(), ground)
    }

    fn away_mm(lines: &[Line], p: [f64; 2]) -> f64 {
        let edges = lines.iter().flat_map(|line| line.points.windows(2));
        edges.map(|e| to_segment_mm(p, e[0].mm(), e[1].mm())).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn no_place_of_a_roof_is_further_than_half_a_distance_from_branch_or_wall() {
        let (layers, _) = grown();
        for x in 1..20 {
            for y in 1..20 {
                let p = [f64::from(x), f64::from(y)];
                let wall_mm = p[0].min(p[1]);
                // Between the points that are looked at it may be half a step more.
                assert!(away_mm(&layers[99], p).min(wall_mm) < 2.0 + 0.71, "{p:?}");
            }
        }
        let under_first = away_mm(&layers[59], [30.0, 30.0]);
        assert!(under_first < 2.71 && away_mm(&layers[61], [30.0, 30.0]) > 5.0, "{under_first}");
    }

    #[test]
    fn every_branch_rests_on_the_layer_below_or_on_a_wall() {
        let (layers, ground) = grown();
        let walls = geometry::EdgeGrid::new(&ground);
        for (below, above) in layers.iter().zip(&layers[1..]) {
            for p in above.iter().flat_map(|line| &line.points) {
                let wall_mm = walls.distance_mm(*p, 1.0);
                let lean_mm = away_mm(below, p.mm()).min(wall_mm);
                assert!(lean_mm <= 2.0 * LEAN * HEIGHT_MM, "{lean_mm} at {:?}", p.mm());
            }
        }
    }

    #[test]
    fn far_below_a_roof_little_is_left() {
        let (layers, _) = grown();
        let length_mm =
            |layer: usize| layers[layer].iter().map(|l| geometry::polyline_length_mm(&l.points)).sum::<f64>();
        assert!(length_mm(0) < 0.4 * length_mm(59), "{} of {}", length_mm(0), length_mm(59));
    }
}
