//! The direction in which lines fill a patch with the fewest turns.

use std::f64::consts::{FRAC_PI_2, PI};

use geometry::Region;
use geometry::real;

/// So many directions are tried besides those of the longest edges.
const EVENLY: usize = 12;
const EDGES: usize = 12;

/// Lines turn elsewhere where that leaves out at least this share of their ends: layers that cross each other are stronger.
const WORTH: f64 = 0.1;

/// Lines keep this far from the direction of those beneath, which may be sparse: 25°.
const APART: f64 = PI / 7.2;

/// The direction of the lines of a patch: `angle_rad`, or one in which a tenth of their ends or more is saved.
///
/// Parallel lines cross the boundary as often as its edges are long across them (Crofton), which is a sum of absolute
/// sines with its minima in the directions of edges. O(edges).
pub fn fewest_turns(patch: &Region, angle_rad: f64) -> f64 {
    let mut edges: Vec<[f64; 2]> = Vec::new();
    for ring in patch.rings() {
        let next = ring.iter().cycle().skip(1);
        edges.extend(ring.iter().zip(next).map(|(a, b)| {
            let ([ax, ay], [bx, by]) = (a.mm(), b.mm());
            [bx - ax, by - ay]
        }));
    }
    let ends = |angle: f64| -> f64 {
        let (sin, cos) = real::sin_cos(angle);
        edges.iter().map(|[dx, dy]| (dy * cos - dx * sin).abs()).sum()
    };
    let mut longest: Vec<(f64, f64)> =
        edges.iter().map(|[dx, dy]| (real::hypot(*dx, *dy), real::atan2(*dy, *dx))).collect();
    longest.sort_by(|a, b| b.0.total_cmp(&a.0));
    let along_edges = longest.into_iter().take(EDGES).map(|(_, angle)| angle);
    let evenly = (1..EVENLY).map(|k| angle_rad + k as f64 * PI / EVENLY as f64);
    let mut best = (ends(angle_rad) * (1.0 - WORTH), angle_rad);
    for angle in along_edges.chain(evenly) {
        // As a turn from `angle_rad` of at most 90° to either side.
        let turn = (angle - angle_rad + FRAC_PI_2).rem_euclid(PI) - FRAC_PI_2;
        if turn.abs() > FRAC_PI_2 - APART {
            continue;
        }
        let count = ends(angle_rad + turn);
        if count < best.0 {
            best = (count, angle_rad + turn);
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::{Point, Polygon};

    fn rectangle(length_mm: f64, width_mm: f64, angle: f64) -> Region {
        let (sin, cos) = angle.sin_cos();
        let corner = |x: f64, y: f64| Point::from_mm(x * cos - y * sin, x * sin + y * cos);
        let outer = vec![
            corner(0.0, 0.0),
            corner(length_mm, 0.0),
            corner(length_mm, width_mm),
            corner(0.0, width_mm),
        ];
        Region::from(Polygon { outer, holes: Vec::new() })
    }

    #[test]
    fn lines_run_along_a_strip() {
        for degrees in [0.0f64, 12.3, 80.0] {
            let found = fewest_turns(&rectangle(30.0, 5.0, degrees.to_radians()), 45f64.to_radians());
            assert!((found.to_degrees() - degrees).abs() < 1e-3, "{degrees}: {}", found.to_degrees());
        }
    }

    #[test]
    fn lines_keep_their_direction_in_what_is_as_long_as_wide() {
        let angle = 1.2;
        assert_eq!(fewest_turns(&rectangle(10.0, 10.0, angle), angle + 0.1), angle + 0.1);
    }

    #[test]
    fn lines_cross_those_beneath() {
        let found = fewest_turns(&rectangle(30.0, 3.0, 0.0), FRAC_PI_2).to_degrees();
        assert!(found.abs() > 24.9, "{found}");
    }
}
