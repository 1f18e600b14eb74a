//! Parallel lines through a region: the scan-line fill behind all straight infill.

use crate::real;

use super::point::nearest_unit;
use super::{BoundaryPos, Point, Region, UNITS_PER_MM};

/// The closest spacing that is taken, in millimetres; it bounds the work on bad settings.
const MIN_SPACING_MM: f64 = 0.001;

/// One end of a hatch segment: the point, and where on the region's boundary it is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HatchEnd {
    /// The end, rounded to the grid.
    pub point: Point,
    /// Its position on the boundary.
    pub on: BoundaryPos,
}

/// A part of a hatch line inside the region.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HatchSegment {
    /// The line is `line · spacing + phase` away from the origin, along the normal.
    pub line: i64,
    /// Its ends, in the hatch direction.
    pub ends: [HatchEnd; 2],
}

#[derive(Clone, Copy, Default)]
struct Crossing {
    along: f64,
    end: HatchEnd,
}

/// Cuts a region with parallel lines.
///
/// Lines run in the direction (cos, sin) of `angle_rad`; line `k` is at the signed distance
/// `k · spacing_mm + phase_mm` from the origin, measured along the normal (−sin, cos). So lines of two
/// regions, or of two layers, coincide. Their parts inside are disjoint; they come line by line, sorted along
/// the direction. What is inside is decided by the even-odd rule over all rings: every vertex is on one side
/// of a line for both of its edges, so each ring is crossed an even number of times, whatever the rounding.
/// A part shorter than the grid's unit vanishes. Ends are within one unit of the exact crossing.
///
/// A spacing that is below 1 µm or NaN gives no line. O(n + m log m) for n vertices and m crossings.
pub fn scan_lines(region: &Region, angle_rad: f64, spacing_mm: f64, phase_mm: f64) -> Vec<HatchSegment> {
    if !(spacing_mm >= MIN_SPACING_MM && angle_rad.is_finite() && phase_mm.is_finite()) {
        return Vec::new();
    }
    let (sin, cos) = direction(angle_rad);
    let (spacing, phase) = (spacing_mm * UNITS_PER_MM, phase_mm * UNITS_PER_MM);
    let height = |p: Point| f64::from(p.y) * cos - f64::from(p.x) * sin;
    // The first line at or above the point. Monotone in the height, which is all that parity needs.
    let line_over = |h: f64| ceil((h - phase) / spacing);

    let heights: Vec<Vec<(f64, i64)>> = region
        .rings()
        .map(|ring| ring.iter().map(|&p| (height(p), line_over(height(p)))).collect())
        .collect();
    let (mut low, mut high) = (i64::MAX, i64::MIN);
    for &(_, line) in heights.iter().flatten() {
        low = low.min(line);
        high = high.max(line);
    }
    if low >= high {
        return Vec::new();
    }

    let edges = || {
        region.rings().zip(&heights).enumerate().flat_map(|(ring_index, (ring, heights))| {
            let next = ring.iter().zip(heights).cycle().skip(1);
            let ends = ring.iter().zip(heights).zip(next).enumerate();
            ends.map(move |(edge, ends)| (ring_index as u32, edge as u32, ends))
        })
    };
    // Where the crossings of each line begin among all of them.
    let mut begins = vec![0_isize; (high - low) as usize + 1];
    for (.., ((_, &(_, over_a)), (_, &(_, over_b)))) in edges() {
        begins[(over_a.min(over_b) - low) as usize] += 1;
        begins[(over_a.max(over_b) - low) as usize] -= 1;
    }
    let (mut count, mut begin) = (0, 0);
    for line in &mut begins {
        count += std::mem::replace(line, begin);
        begin += count;
    }
    let mut crossings = vec![Crossing::default(); begin as usize];
    for (ring, edge, ((&a, &(height_a, over_a)), (&b, &(height_b, over_b)))) in edges() {
        if over_a == over_b {
            continue;
        }
        let (dx, dy) = (f64::from(b.x) - f64::from(a.x), f64::from(b.y) - f64::from(a.y));
        let length_mm = (dx * dx + dy * dy).sqrt() / UNITS_PER_MM;
        for line in over_a.min(over_b)..over_a.max(over_b) {
            let t = ((line as f64 * spacing + phase - height_a) / (height_b - height_a)).clamp(0.0, 1.0);
            let (x, y) = (f64::from(a.x) + t * dx, f64::from(a.y) + t * dy);
            let on = BoundaryPos { ring, edge, along_mm: t * length_mm };
            let point = Point::new(nearest_unit(x), nearest_unit(y));
            let next = &mut begins[(line - low) as usize];
            crossings[*next as usize] = Crossing { along: x * cos + y * sin, end: HatchEnd { point, on } };
            *next += 1;
        }
    }

    let mut hatch = Vec::with_capacity(crossings.len() / 2);
    let mut from = 0;
    // By now each line begins where the next one did.
    for (line, &to) in (low..high).zip(&begins) {
        let crossings = &mut crossings[std::mem::replace(&mut from, to as usize)..to as usize];
        if !crossings.is_sorted_by(|a, b| a.along.total_cmp(&b.along).is_le()) {
            crossings.sort_by(|a, b| a.along.total_cmp(&b.along));
        }
        let ends = crossings.chunks_exact(2).map(|pair| [pair[0].end, pair[1].end]);
        hatch.extend(ends.filter(|[a, b]| a.point != b.point).map(|ends| HatchSegment { line, ends }));
    }
    hatch
}

/// The smallest integer not below `v`: `f64::ceil` without its function call.
fn ceil(v: f64) -> i64 {
    let whole = v as i64;
    whole + i64::from(v > whole as f64)
}

/// Sine and cosine, exact at multiples of a quarter turn, so that axis-parallel lines are just that.
fn direction(angle_rad: f64) -> (f64, f64) {
    let clean = |v: f64| if v.abs() < 1e-15 { 0.0 } else { v };
    let (sin, cos) = real::sin_cos(angle_rad);
    (clean(sin), clean(cos))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Polygon, Ring};
    use std::f64::consts::{FRAC_PI_2, PI};

    fn ring(points: &[(f64, f64)]) -> Ring {
        points.iter().map(|&(x, y)| Point::from_mm(x, y)).collect()
    }

    fn frame() -> Region {
        let outer = ring(&[(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)]);
        let hole = ring(&[(4.0, 4.0), (4.0, 6.0), (6.0, 6.0), (6.0, 4.0)]);
        Region { polygons: vec![Polygon { outer, holes: vec![hole] }] }
    }

    #[test]
    fn holes_split_lines() {
        let segments = scan_lines(&frame(), 0.0, 1.0, 0.5);
        let lines: Vec<i64> = segments.iter().map(|segment| segment.line).collect();
        assert_eq!(lines, [0, 1, 2, 3, 4, 4, 5, 5, 6, 7, 8, 9]);
        let [left, right] = [4, 5].map(|k| segments[k].ends.map(|end| end.point));
        assert_eq!(left, [Point::from_mm(0.0, 4.5), Point::from_mm(4.0, 4.5)]);
        assert_eq!(right, [Point::from_mm(6.0, 4.5), Point::from_mm(10.0, 4.5)]);
    }

    #[test]
    fn ends_know_their_place_on_the_boundary() {
        let [left, right] = scan_lines(&frame(), 0.0, 1.0, 0.5)[4].ends;
        assert_eq!((left.on.ring, left.on.edge, left.on.along_mm), (0, 3, 5.5));
        assert_eq!((right.on.ring, right.on.edge, right.on.along_mm), (1, 0, 0.5));
    }

    #[test]
    fn lines_stay_in_place_when_the_region_moves() {
        let frame = frame();
        let moved = frame.translated(Point::from_mm(0.3, 0.4));
        for region in [frame, moved] {
            for segment in scan_lines(&region, FRAC_PI_2, 0.7, 0.1) {
                for end in segment.ends {
                    let x_mm = -(segment.line as f64 * 0.7 + 0.1);
                    assert!((end.point.mm()[0] - x_mm).abs() < 1e-5);
                }
            }
        }
    }

    #[test]
    fn length_times_spacing_is_area() {
        for step in 0..16 {
            let angle = PI * f64::from(step) / 16.0;
            let total: f64 = scan_lines(&frame(), angle, 0.05, 0.0)
                .iter()
                .map(|HatchSegment { ends: [a, b], .. }| a.point.distance_mm(b.point))
                .sum();
            assert!((total * 0.05 - 96.0).abs() < 0.6, "{angle}: {}", total * 0.05);
        }
    }

    #[test]
    fn lines_through_vertices_and_along_edges_pair_up() {
        // Spacing 1 at phase 0 runs along four edges and through all eight vertices.
        for line in scan_lines(&frame(), 0.0, 1.0, 0.0).chunk_by(|a, b| a.line == b.line) {
            let total: f64 = line.iter().map(|part| part.ends[0].point.distance_mm(part.ends[1].point)).sum();
            assert!(total == 10.0 || total == 8.0, "{total}");
        }
    }

    #[test]
    fn bad_settings_give_no_lines() {
        for spacing in [0.0, -1.0, f64::NAN, 1e-9] {
            assert!(scan_lines(&frame(), 0.0, spacing, 0.0).is_empty());
        }
        assert!(scan_lines(&Region::default(), 0.0, 1.0, 0.0).is_empty());
    }

    #[test]
    fn far_coordinates_do_not_overflow() {
        let far = 9_990.0;
        let outer = ring(&[(-far, -far), (far, -far), (far, far), (-far, far)]);
        let region = Region { polygons: vec![Polygon { outer, holes: vec![] }] };
        assert_eq!(scan_lines(&region, 0.7, 1000.0, 0.0).len(), 29);
    }
}
