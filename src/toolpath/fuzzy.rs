//! A rough surface: points of walls, moved at random to either side of the line.
//!
//! Coarse by intent, but within bounds: no point of the wall leaves its line by more than the requested thickness.
//! Walls that rest on nothing, and those on the bed, stay as they are.

use super::options::{FuzzySettings, FuzzyWalls};
use geometry::Random;
use geometry::real;
use geometry::{EdgeGrid, Point, Region};

use super::bead::Line;

/// Share of the thickness that lines may lose in detail; the rest is what points are moved by.
const DETAIL: f64 = 0.1;

/// Points between corners lie off their even places by up to this share of their distance.
const SPREAD: f64 = 0.25;

/// The fuzzy skin of one object on one layer.
pub(super) struct Fuzzy<'a> {
    settings: &'a FuzzySettings,
    beneath: EdgeGrid,
    seed: u64,
}

impl<'a> Fuzzy<'a> {
    /// `None`: nothing is rough here. `beneath`: the section of the layer below, `None` on the bed.
    pub fn new(
        settings: &'a FuzzySettings,
        beneath: Option<&Region>,
        layer: usize,
        object: u32,
    ) -> Option<Self> {
        let beneath = beneath.filter(|_| settings.walls != FuzzyWalls::None && layer > 0)?;
        let seed = (layer as u64) << 32 | u64::from(object);
        Some(Self { settings, beneath: EdgeGrid::new(beneath), seed })
    }

    /// Roughens the loops of a depth, 0 the outermost.
    pub fn roughen(&self, lines: Vec<Line>, depth: usize) -> Vec<Line> {
        if depth > 0 && self.settings.walls == FuzzyWalls::Outer {
            return lines;
        }
        lines.into_iter().map(|line| if line.closed { self.rough(&line) } else { line }).collect()
    }

    fn rough(&self, line: &Line) -> Line {
        let (thickness_mm, distance_mm) = (self.settings.thickness.0, self.settings.distance.0);
        let corners = simplified(&line.points, DETAIL * thickness_mm);
        // From the line itself, so that it does not depend on what else there is on the layer.
        let start = line.points[0];
        let mut random = Random::new(self.seed ^ (start.x as u32 as u64) << 32 ^ start.y as u32 as u64);
        let mut out = Line { points: Vec::new(), spacing_mm: Vec::new(), closed: true };
        for (i, &from) in corners.iter().enumerate() {
            let next = corners[(i + 1) % corners.len()];
            let (a, b) = (line.points[from].mm(), line.points[next].mm());
            let edge_mm = real::hypot(b[0] - a[0], b[1] - a[1]).max(f64::MIN_POSITIVE);
            let normal = [(b[1] - a[1]) / edge_mm, (a[0] - b[0]) / edge_mm];
            let parts = (edge_mm / distance_mm).round().clamp(1.0, 1e6) as u32;
            for part in 0..parts {
                // Corners stay in the line, the points between do not lie like the teeth of a saw.
                let jitter = if part > 0 { SPREAD * random.either() } else { 0.0 };
                let share = (f64::from(part) + jitter) / f64::from(parts);
                let p = [0, 1].map(|k| a[k] + share * (b[k] - a[k]));
                let by_mm = match self.beneath.contains(Point::from_mm(p[0], p[1])) {
                    true => (1.0 - DETAIL) * thickness_mm * random.either(),
                    false => 0.0,
                };
                let moved = Point::from_mm(p[0] + by_mm * normal[0], p[1] + by_mm * normal[1]);
                if out.points.last() != Some(&moved) {
                    out.points.push(moved);
                    if !line.spacing_mm.is_empty() {
                        let (a, b) = (line.spacing_mm[from], line.spacing_mm[next]);
                        out.spacing_mm.push(a + share as f32 * (b - a));
                    }
                }
            }
        }
        out.sound().unwrap_or_else(|| line.clone())
    }
}

/// Indices of the vertices that remain when a ring is simplified within a distance. Douglas & Peucker 1973,
/// <https://doi.org/10.3138/FM57-6770-U75U-7727>, from the first vertex and the one farthest from it.
fn simplified(ring: &[Point], tolerance_mm: f64) -> Vec<usize> {
    let away = |i: usize| {
        let ([x, y], [x0, y0]) = (ring[i].mm(), ring[0].mm());
        real::hypot(x - x0, y - y0)
    };
    let far = (1..ring.len()).max_by(|&a, &b| away(a).total_cmp(&away(b)).then(b.cmp(&a))).unwrap_or(0);
    let mut kept = vec![false; ring.len()];
    (kept[0], kept[far]) = (true, true);
    let mut open = vec![(0, far), (far, ring.len())];
    while let Some((from, to)) = open.pop() {
        let (a, b) = (ring[from].mm(), ring[to % ring.len()].mm());
        let off = |i: usize| geometry::to_segment_mm(ring[i].mm(), a, b);
        let worst = (from + 1..to).max_by(|&a, &b| off(a).total_cmp(&off(b)).then(b.cmp(&a)));
        if let Some(worst) = worst.filter(|&i| off(i) > tolerance_mm) {
            kept[worst] = true;
            open.extend([(from, worst), (worst, to)]);
        }
    }
    (0..ring.len()).filter(|&i| kept[i]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::Mm;
    use geometry::Polygon;

    fn square(side_mm: f64) -> Region {
        let corners = [(0.0, 0.0), (side_mm, 0.0), (side_mm, side_mm), (0.0, side_mm)];
        let outer = corners.map(|(x, y)| Point::from_mm(x, y)).to_vec();
        Region::from(Polygon { outer, holes: vec![] })
    }

    fn line(region: &Region) -> Line {
        Line::nominal(region.polygons()[0].outer.clone(), true)
    }

    fn settings(thickness_mm: f64) -> FuzzySettings {
        FuzzySettings { walls: FuzzyWalls::Outer, thickness: Mm(thickness_mm), ..FuzzySettings::default() }
    }

    #[test]
    fn a_rough_wall_stays_within_the_thickness_and_uses_most_of_it() {
        let (settings, wall) = (settings(0.3), square(20.0));
        let fuzzy = Fuzzy::new(&settings, Some(&wall), 3, 0).unwrap();
        let beneath = geometry::offset(&wall, 1.0);
        let fuzzy = Fuzzy { beneath: EdgeGrid::new(&beneath), ..fuzzy };
        let grid = EdgeGrid::new(&wall);
        let rough = fuzzy.roughen(vec![line(&wall)], 0).remove(0);
        let off: Vec<f64> = rough.points.iter().map(|p| grid.distance_mm(*p, 5.0)).collect();
        assert!(off.iter().all(|mm| *mm <= 0.3), "{off:?}");
        assert!(off.iter().any(|mm| *mm > 0.2), "{off:?}");
        let expected = 80.0 / settings.distance.0;
        assert!((off.len() as f64 - expected).abs() < 0.15 * expected + 4.0, "{}", off.len());
        assert_eq!(fuzzy.roughen(vec![line(&wall)], 1), [line(&wall)], "inner walls stay");
        assert_eq!(fuzzy.roughen(vec![line(&wall)], 0), [rough], "the same each time");
    }

    #[test]
    fn what_hangs_over_nothing_and_the_first_layer_stay() {
        let (settings, wall) = (settings(0.3), square(20.0));
        let fuzzy = Fuzzy::new(&settings, Some(Region::EMPTY), 3, 0).unwrap();
        let grid = EdgeGrid::new(&wall);
        let rough = fuzzy.roughen(vec![line(&wall)], 0).remove(0);
        assert!(rough.points.iter().all(|p| grid.distance_mm(*p, 1.0) < 1e-4));
        assert!(Fuzzy::new(&settings, None, 3, 0).is_none());
        assert!(Fuzzy::new(&settings, Some(&wall), 0, 0).is_none());
    }
}
