//! Finds the stretches of a polyline that follow a circle, to be written as one G2 or G3 each.

use super::simplify::MERGE_TOLERANCE_MM;
use geometry::real;
use geometry::{distance_mm, to_segment_mm};

/// An arc replaces at least this many segments: fewer are no shorter as arcs.
const MIN_SEGMENTS: usize = 3;

/// Flatter arcs are left as lines: with I and J in micrometres a larger radius gains nothing.
const MAX_RADIUS_MM: f64 = 1000.0;

/// Part of a polyline: from the end of the part before it to vertex `end`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Part {
    /// Index of its last vertex.
    pub end: usize,
    /// Its circle, or `None` of a plain polyline.
    pub arc: Option<Circle>,
}

/// The circle of an arc and the sense in which it is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Circle {
    pub center: [f64; 2],
    pub clockwise: bool,
}

/// Cuts a polyline into arcs and plain stretches. An arc begins and ends on vertices, turns by at most half a
/// circle, and nowhere lies further than `tolerance_mm` from the polyline. Greedy, longest arc first from
/// each vertex; O(n log n).
pub(super) fn parts(points: &[[f64; 2]], tolerance_mm: f64) -> Vec<Part> {
    let mut out: Vec<Part> = Vec::new();
    let mut start = 0;
    while start + 1 < points.len() {
        match longest(&points[start..], tolerance_mm) {
            Ok((segments, circle)) => {
                start += segments;
                out.push(Part { end: start, arc: Some(circle) });
            }
            Err(flat) => {
                start += (flat / 2).max(1);
                match out.last_mut() {
                    Some(part) if part.arc.is_none() => part.end = start,
                    _ => out.push(Part { end: start, arc: None }),
                }
            }
        }
    }
    out
}

/// The most segments from the first vertex on that one arc can replace: doubled until it fails, then bisected.
/// Where none begins here, the error says how many segments are as good as straight.
fn longest(points: &[[f64; 2]], tolerance_mm: f64) -> Result<(usize, Circle), usize> {
    let most = points.len() - 1;
    if most < MIN_SEGMENTS {
        return Err(most);
    }
    let mut best = Err(MIN_SEGMENTS - 1);
    let (mut fits, mut fails) = (MIN_SEGMENTS - 1, most + 1);
    while fits + 1 < fails {
        let next = if fails > most { (2 * fits).min(most) } else { fits + (fails - fits) / 2 };
        match fit(&points[..=next], tolerance_mm) {
            Fit::Arc(circle) => (fits, best) = (next, Ok((next, circle))),
            Fit::Flat => (fits, best) = (next, best.or(Err(next))),
            Fit::Bad => fails = next,
        }
    }
    best
}

/// The result of fitting an arc to a stretch.
enum Fit {
    /// It follows this circle.
    Arc(Circle),
    /// It is as good as straight so far.
    Flat,
    /// It does not follow any.
    Bad,
}

/// The circle through both ends that fits the vertices between best, if it is near enough everywhere.
///
/// In coordinates along (x, from 0 to L) and across (y) the chord, circles through both ends satisfy
/// x² − Lx + y² = 2cy; c, the centre's distance from the chord, is found by linear least squares.
fn fit(points: &[[f64; 2]], tolerance_mm: f64) -> Fit {
    let (a, b) = (points[0], points[points.len() - 1]);
    let chord_mm = distance_mm(a, b);
    if chord_mm <= MERGE_TOLERANCE_MM {
        return Fit::Bad;
    }
    let along = [(b[0] - a[0]) / chord_mm, (b[1] - a[1]) / chord_mm];
    let (mut yy, mut yq, mut bulge_mm) = (0.0, 0.0, 0.0_f64);
    for p in points {
        let d = [p[0] - a[0], p[1] - a[1]];
        let (x, y) = (d[0] * along[0] + d[1] * along[1], d[1] * along[0] - d[0] * along[1]);
        yy += y * y;
        yq += y * (x * x - chord_mm * x + y * y);
        bulge_mm = bulge_mm.max(y.abs());
    }
    if bulge_mm <= 2.0 * MERGE_TOLERANCE_MM {
        return Fit::Flat;
    }
    let c = 0.5 * yq / yy;
    let center = [0.5 * (a[0] + b[0]) - c * along[1], 0.5 * (a[1] + b[1]) + c * along[0]];
    let radius_mm = distance_mm(a, center);
    if radius_mm > MAX_RADIUS_MM {
        return Fit::Flat;
    }
    let first_turn = turn(points[0], points[1], center);
    let mut swept = 0.0;
    for pair in points.windows(2) {
        let turn = turn(pair[0], pair[1], center);
        if turn * first_turn <= 0.0 {
            return Fit::Bad;
        }
        swept += turn.abs();
        let off_mm = (distance_mm(pair[1], center) - radius_mm).abs();
        let sag_mm = (radius_mm - to_segment_mm(center, pair[0], pair[1])).abs();
        if off_mm > tolerance_mm || sag_mm > tolerance_mm {
            return Fit::Bad;
        }
    }
    // A shade more than half a circle, so that a half one is not lost to rounding.
    if swept > std::f64::consts::PI + 1e-6 {
        return Fit::Bad;
    }
    Fit::Arc(Circle { center, clockwise: first_turn < 0.0 })
}

/// Angle from `a` to `b` seen from the centre, counter-clockwise positive.
fn turn(a: [f64; 2], b: [f64; 2], center: [f64; 2]) -> f64 {
    let (u, v) = ([a[0] - center[0], a[1] - center[1]], [b[0] - center[0], b[1] - center[1]]);
    real::atan2(u[0] * v[1] - u[1] * v[0], u[0] * v[0] + u[1] * v[1])
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn circle(radius_mm: f64, segments: u32, share: f64) -> Vec<[f64; 2]> {
        (0..=segments)
            .map(|i| share * TAU * f64::from(i) / f64::from(segments))
            .map(|t| [50.0 + radius_mm * t.cos(), 50.0 + radius_mm * t.sin()])
            .collect()
    }

    #[test]
    fn a_circle_becomes_few_arcs_around_its_centre() {
        let parts = parts(&circle(10.0, 100, 1.0), 0.01);
        assert!(parts.len() <= 3, "{parts:?}");
        for part in &parts {
            let arc = part.arc.expect("all of it is round");
            assert!(distance_mm(arc.center, [50.0, 50.0]) < 0.01 && !arc.clockwise);
        }
        assert_eq!(parts.last().map(|p| p.end), Some(100));
    }

    #[test]
    fn a_coarse_polygon_stays_one() {
        let parts = parts(&circle(10.0, 8, 1.0), 0.02);
        assert_eq!(parts, [Part { end: 8, arc: None }]);
    }

    #[test]
    fn a_straight_line_and_a_zigzag_are_no_arcs() {
        let line: Vec<[f64; 2]> = (0..20).map(|i| [f64::from(i), 2.0]).collect();
        let zigzag: Vec<[f64; 2]> = (0..20).map(|i| [f64::from(i), f64::from(i % 2)]).collect();
        for points in [line, zigzag] {
            assert_eq!(parts(&points, 0.02), [Part { end: 19, arc: None }]);
        }
    }

    #[test]
    fn too_few_points_give_no_part() {
        assert!(parts(&[], 0.02).is_empty() && parts(&[[1.0, 1.0]], 0.02).is_empty());
    }
}
