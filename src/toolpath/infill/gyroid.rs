//! The gyroid, a triply periodic minimal surface: sin x · cos y + sin y · cos z + sin z · cos x = 0.
//!
//! A. H. Schoen, "Infinite periodic minimal surfaces without self-intersections", NASA TN D-5541, 1970. At a
//! given height the surface is a family of waves that can be solved for one coordinate: with
//! a = sin x, b = cos z, the equation reads √(a² + b²) · cos(y − atan2(b, a)) = −cos x · sin z, which has
//! solutions for all x where |cos z| ≥ |sin z|; at other heights x and y change places.

use std::f64::consts::TAU;

use geometry::real;
use geometry::{Clipper, Point, Region, to_mm};

use super::super::bead::Line;
use super::connect::connect;
use super::pattern::FillPattern;
use super::spec::Chord;
use super::spec::FillSpec;
use super::waves;

/// Steps in a period: the chord error of a wave is below 1 % of its amplitude.
const STEPS: usize = 24;

/// Period in mean bead distances: two waves in a period, each about 1.22 times as long as a straight line.
const PERIOD: f64 = 2.0 * 1.22;

/// See the module.
#[derive(Debug)]
pub struct Gyroid;

impl FillPattern for Gyroid {
    fn fill(&self, region: &Region, spec: &FillSpec) -> Vec<Line> {
        let Some(bounds) = region.bounds() else {
            return Vec::new();
        };
        let scale = TAU / (PERIOD * spec.line_distance_mm);
        let z = spec.z_mm * scale;
        let (sin_z, cos_z) = real::sin_cos(z);
        let upright = cos_z.abs() < sin_z.abs();
        let low = [to_mm(bounds.min.x) * scale, to_mm(bounds.min.y) * scale];
        let high = [to_mm(bounds.max.x) * scale, to_mm(bounds.max.y) * scale];
        // `u` runs along the waves, `v` across them.
        let (u, v) = if upright { (1, 0) } else { (0, 1) };
        let step = TAU / STEPS as f64;
        let (first, last) = ((low[u] / step).floor() as i64 - 1, (high[u] / step).ceil() as i64 + 1);
        let at = |u: f64, branch: f64| -> f64 {
            let (sin, cos) = real::sin_cos(u);
            let (a, b, rhs) = if upright { (cos, sin_z, -sin * cos_z) } else { (sin, cos_z, -cos * sin_z) };
            // Where upright, cos(x − φ) has φ = atan2(cos y, sin z), the angle between sin x and cos x swapped.
            let phase = if upright { real::atan2(a, b) } else { real::atan2(b, a) };
            let phase = if upright && b < 0.0 && phase < 0.0 { phase + TAU } else { phase };
            phase + branch * real::acos((rhs / real::hypot(a, b)).clamp(-1.0, 1.0))
        };

        let clipper = Clipper::new(region);
        let mut chords = Vec::new();
        let periods = (low[v] / TAU).floor() as i64 - 2..=(high[v] / TAU).ceil() as i64 + 1;
        for (period, branch) in periods.flat_map(|k| [(k, -1.0), (k, 1.0)]) {
            let wave: Vec<Point> = (first..=last)
                .map(|i| {
                    let along = i as f64 * step;
                    let across = at(along, branch) + period as f64 * TAU;
                    let (x, y) = if upright { (across, along) } else { (along, across) };
                    waves::on_grid([x / scale, y / scale])
                })
                .collect();
            let line = 2 * period + i64::from(branch > 0.0);
            chords.extend(clipper.clip(&wave).into_iter().map(|piece| Chord {
                points: piece.points,
                ends: piece.ends,
                line,
            }));
        }
        connect(region, chords, &spec.joins)
    }
}

#[cfg(test)]
mod tests {
    use super::super::Joins;
    use super::*;
    use geometry::Polygon;

    #[test]
    fn waves_lie_on_the_surface() {
        let corner = |x, y| Point::from_mm(x, y);
        let outer = vec![corner(0.0, 0.0), corner(40.0, 0.0), corner(40.0, 30.0), corner(0.0, 30.0)];
        let region = Region::from(Polygon { outer, holes: vec![] });
        for layer in 0..40 {
            let z_mm = 0.1 + 0.2 * layer as f64;
            let spec = FillSpec {
                line_distance_mm: 2.0,
                spacing_mm: 0.4,
                angle_rad: 0.0,
                layer,
                z_mm,
                joins: Joins::default(),
            };
            let scale = TAU / (PERIOD * 2.0);
            let lines = Gyroid.fill(&region, &spec);
            assert!(!lines.is_empty());
            for p in lines.iter().flat_map(|l| &l.points[1..l.points.len() - 1]) {
                let [x, y] = p.mm().map(|v| v * scale);
                let z = z_mm * scale;
                let value = x.sin() * y.cos() + y.sin() * z.cos() + z.sin() * x.cos();
                assert!(value.abs() < 1e-3, "off the surface by {value} at layer {layer}");
            }
        }
    }
}
