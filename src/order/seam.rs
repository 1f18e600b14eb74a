//! Where loops may be entered: the seam rules.

use std::collections::BTreeMap;

use super::options::SeamPosition;
use crate::toolpath::{LayerPaths, Path};
use geometry::Point;
use geometry::real;
use ordering::matching::KdTree;
use ordering::{Problem, Sequence, Shape};

/// A turn sharper than this is a corner, in which a seam hides (30°).
const CORNER_SIN: f64 = 0.5;
/// Corners are alike in sharpness within a tenth of it.
const SHARPNESS_STEPS: f64 = 10.0;
/// How far along a loop `aligned` looks for a corner around the place above the last seam, mm.
const CORNER_REACH_MM: f64 = 1.0;
/// A loop whose nearest seam below is farther away than this begins a new seam, mm.
const ALIGNED_REACH_MM: f64 = 5.0;
/// Seams of so many layers below are remembered.
const REMEMBERED: usize = 16;
/// Vertices of a loop from which the seam below is looked for.
const SAMPLES: usize = 32;

/// For each path of a layer the one vertex where it may be entered, or `None`: any.
pub type Pins = Option<Vec<u32>>;

/// Applies a seam rule to the layers of a print, from the first to the last.
///
/// `aligned` remembers the seams of the layers before, of which it follows those of the one below; the other rules look at
/// one layer only.
#[derive(Clone, Debug)]
pub struct SeamRule {
    position: SeamPosition,
    /// The seams of the last layers, by their index.
    seams: BTreeMap<usize, Vec<Point>>,
}

impl SeamRule {
    /// A rule before the first layer.
    pub fn new(position: SeamPosition) -> Self {
        Self { position, seams: BTreeMap::new() }
    }

    /// The entries that the rule leaves to the next layer. `nearest` leaves all: see [`enter_nearest`].
    pub fn pins(&mut self, layer: &LayerPaths) -> Pins {
        let choose: &dyn Fn(usize) -> u32 = match self.position {
            SeamPosition::Free | SeamPosition::Nearest => return None,
            SeamPosition::Pinned => &|path| allowed(layer, path).next().unwrap_or(0) as u32,
            SeamPosition::Rear => &|path| rearmost(&layer.paths[path].points, allowed(layer, path)),
            SeamPosition::Random => &|path| {
                let count = allowed(layer, path).count() as u64;
                let chosen = scatter(layer.index as u64, path as u64) % count;
                allowed(layer, path).nth(chosen as usize).unwrap_or(0) as u32
            },
            SeamPosition::Aligned => {
                let below = self.seams.range(..layer.index).next_back().map_or(&[][..], |(_, seams)| seams);
                let pins = aligned(layer, below);
                // Loops of infill are not seen; walls above need not follow their seams.
                let paths = layer.paths.iter().zip(&pins);
                let closed = paths.filter(|(path, _)| path.closed && path.role.is_wall());
                let found = closed.map(|(path, &pin)| path.points[pin as usize]);
                self.seams.entry(layer.index).or_default().extend(found);
                // Layers may be printed in several turns.
                self.seams = self.seams.split_off(&layer.index.saturating_sub(REMEMBERED));
                return Some(pins);
            }
        };
        Some((0..layer.paths.len()).map(choose).collect())
    }
}

/// The vertices at which a path may be entered.
fn allowed(layer: &LayerPaths, path: usize) -> impl Iterator<Item = usize> + Clone {
    let painted = layer.entries.get(&(path as u32)).map(|entries| entries.vertices.as_slice());
    let all = painted.map_or(layer.paths[path].points.len(), <[u32]>::len);
    (0..all).map(move |k| painted.map_or(k, |vertices| vertices[k] as usize))
}

/// Of some vertices the one with the largest ordinate; of several the leftmost, then the first.
fn rearmost(points: &[Point], among: impl Iterator<Item = usize>) -> u32 {
    let key = |&index: &usize| (points[index].y, -i64::from(points[index].x), std::cmp::Reverse(index));
    among.max_by_key(key).unwrap_or(0) as u32
}

/// Two numbers to an evenly spread third (the finaliser of SplitMix64, Steele, Lea & Flood 2014,
/// doi:10.1145/2660193.2660195).
fn scatter(a: u64, b: u64) -> u64 {
    let mut z = a.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ b.wrapping_add(0x632b_e59b_d9b4_e019);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// The vertex above the nearest seam of the layer below, in the best corner nearby if there is one; without one below
/// in the best corner, else at the rear. Concave corners hide a seam better than convex ones, and sharp ones better
/// than blunt ones; of several alike the rearmost is taken.
fn aligned(layer: &LayerPaths, below: &[Point]) -> Vec<u32> {
    let seams = KdTree::new(below);
    let nearest_seam = |points: &[Point]| {
        let samples = points.iter().step_by(points.len().div_ceil(SAMPLES));
        let found = samples.filter_map(|&p| seams.nearest(below, p)).min()?;
        Some(below[found.1 as usize])
    };
    let pin = |points: &[Point], path: usize| {
        let all = allowed(layer, path);
        let seam = nearest_seam(points);
        let above = seam.and_then(|seam| all.clone().min_by_key(|&v| (points[v].distance2(seam), v)));
        let above =
            above.filter(|&v| seam.is_some_and(|seam| points[v].distance_mm(seam) < ALIGNED_REACH_MM));
        let corner = all
            .clone()
            .filter(|&v| above.is_none_or(|above| points[above].distance_mm(points[v]) < CORNER_REACH_MM))
            .map(|v| (turn(points, v), v))
            .filter(|&(turn, _)| turn.abs() > CORNER_SIN)
            .max_by_key(|&(turn, v)| {
                let sharp = (turn.abs() * SHARPNESS_STEPS) as i64;
                (turn < 0.0, sharp, points[v].y, -i64::from(points[v].x), std::cmp::Reverse(v))
            });
        corner.map(|(_, v)| v).or(above).map_or_else(|| rearmost(points, all), |v| v as u32)
    };
    let pin = |(number, path): (usize, &Path)| if path.closed { pin(&path.points, number) } else { 0 };
    layer.paths.iter().enumerate().map(pin).collect()
}

/// How sharply a loop turns at a vertex: the sine of the angle up to 90°, more beyond; negative to the right, which
/// is a concave corner, for loops have the part on their left.
fn turn(points: &[Point], vertex: usize) -> f64 {
    let n = points.len();
    let (a, b, c) = (points[(vertex + n - 1) % n].mm(), points[vertex].mm(), points[(vertex + 1) % n].mm());
    let (u, v) = ([b[0] - a[0], b[1] - a[1]], [c[0] - b[0], c[1] - b[1]]);
    let lengths = real::hypot(u[0], u[1]) * real::hypot(v[0], v[1]);
    if lengths == 0.0 {
        return 0.0;
    }
    let (sin, cos) = ((u[0] * v[1] - u[1] * v[0]) / lengths, (u[0] * v[0] + u[1] * v[1]) / lengths);
    if cos >= 0.0 { sin } else { (1.0 - cos).copysign(sin) }
}

/// Enters every loop of a solution at the vertex nearest to where the nozzle comes from (`seam = nearest`).
/// O(vertices).
pub fn enter_nearest(problem: &Problem, sequence: &mut Sequence) {
    let mut at = problem.start;
    for visit in sequence {
        let item = &problem.items[visit.item as usize];
        if let (Shape::Loop(vertices), Some(from)) = (item.shape, at) {
            let nearest = (0..vertices.len()).min_by_key(|&v| (vertices[v].distance2(from), v));
            visit.entry = nearest.map_or(visit.entry, |v| v as u32);
        }
        at = Some(item.ends(visit.entry).1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::toolpath::{IslandId, LayerKind, Phase, Role, Width};
    use geometry::Region;

    fn square(index: usize, offset_mm: f64) -> LayerPaths {
        let corner = |x, y| Point::from_mm(x + offset_mm, y);
        LayerPaths {
            index,
            top_mm: 0.2,
            height_mm: 0.2,
            islands: Vec::new(),
            paths: vec![Path {
                role: Role::Perimeter,
                closed: true,
                points: vec![
                    corner(0., 0.),
                    corner(5., 0.),
                    corner(10., 0.),
                    corner(10., 10.),
                    corner(0., 10.),
                ],
                width: Width::Constant(0.4),
                height_mm: 0.2,
                island: Some(IslandId(0)),
                phase: Phase::Wall(0),
                tool: None,
            }],
            outline: Region::default(),
            beneath: None,
            kind: LayerKind::Flat,
            entries: Default::default(),
            tools: Vec::new(),
            rams: Vec::new(),
            turn: Default::default(),
        }
    }

    #[test]
    fn rear_is_the_vertex_with_the_largest_y() {
        assert_eq!(SeamRule::new(SeamPosition::Rear).pins(&square(0, 0.0)), Some(vec![4]));
    }

    #[test]
    fn aligned_seams_follow_the_corner_of_the_layer_below() {
        let mut rule = SeamRule::new(SeamPosition::Aligned);
        let first = rule.pins(&square(0, 0.0));
        for layer in 1..20 {
            assert_eq!(rule.pins(&square(layer, 0.1 * layer as f64)), first);
        }
    }

    #[test]
    fn aligned_seams_hide_in_the_concave_corner() {
        let mut layer = square(0, 0.0);
        layer.paths[0].points[1] = Point::from_mm(5.0, 4.0);
        assert_eq!(SeamRule::new(SeamPosition::Aligned).pins(&layer), Some(vec![1]));
    }

    #[test]
    fn random_seams_differ_between_layers() {
        let mut rule = SeamRule::new(SeamPosition::Random);
        let pins: std::collections::BTreeSet<_> =
            (0..20).map(|layer| rule.pins(&square(layer, 0.0))).collect();
        assert!(pins.len() > 2);
    }
}
