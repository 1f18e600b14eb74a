//! Beds: from the corners of a polygon to a rectangle or a disc.

use geometry::real;
use toml::Value;

use super::row::Outcome::{self, Left, Near};
use crate::presets::Config;

/// How far a bed's outline may be from a rectangle or a circle, in millimetres.
const TOLERANCE_MM: f64 = 0.1;

/// Steps in which a rectangle is made smaller until it lies inside of an outline.
const STEPS: u32 = 500;

/// A bed of ours.
struct Bed {
    round: bool,
    size: [f64; 2],
    /// The middle lies at `offset`, and not the corner.
    centered: bool,
    offset: [f64; 2],
    /// It is not all of theirs.
    is_part: bool,
}

type Point = [f64; 2];

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= TOLERANCE_MM
}

/// In hundredths of a millimetre.
fn rounded(value: f64) -> f64 {
    (value * 100.0).round() / 100.0 + 0.0
}

/// Where nothing may be printed: a rectangle for every four points, or else those within the outline that they are, whose parts
/// may hang together by lines to and fro.
pub(super) fn excluded(config: &Config) -> Outcome {
    let Some(points) = points(config, "bed_exclude_area") else { return Outcome::Idle };
    let bounds = |corners: &[Point]| {
        let bound =
            |i: usize, pick: fn(f64, f64) -> f64| corners.iter().map(|p| p[i]).reduce(pick).unwrap_or(0.0);
        [bound(0, f64::min), bound(1, f64::min), bound(0, f64::max), bound(1, f64::max)]
    };
    let is_rectangle = |corners: &[Point]| {
        let [left, front, right, back] = bounds(corners);
        let at_corner =
            |p: &Point| (near(p[0], left) || near(p[0], right)) && (near(p[1], front) || near(p[1], back));
        corners.len() > 2 && corners.iter().all(at_corner)
    };
    let rectangles: Vec<[f64; 4]> = if points.chunks(4).all(is_rectangle) {
        points.chunks(4).map(bounds).collect()
    } else {
        rectangles_within(&points)
    };
    Outcome::Value(Value::Array(rectangles.into_iter().flatten().map(Value::Float).collect()))
}

/// Rectangles, `[left, front, right, back]`, that cover what an outline goes around, however often; where its sides are straight
/// along X and Y they are exactly that.
fn rectangles_within(outline: &[Point]) -> Vec<[f64; 4]> {
    let mut ends: Vec<f64> = outline.iter().map(|p| p[1]).collect();
    ends.sort_by(f64::total_cmp);
    ends.dedup_by(|a, b| near(*a, *b));
    let mut out: Vec<[f64; 4]> = Vec::new();
    for strip in ends.windows(2) {
        let (front, back) = (strip[0], strip[1]);
        let middle = (front + back) / 2.0;
        // Where sides cross the strip: in its middle, their ends in it, and which way.
        let mut sides: Vec<(f64, [f64; 2], i32)> = Vec::new();
        for (a, b) in outline.iter().zip(outline.iter().cycle().skip(1)) {
            if (a[1] > middle) == (b[1] > middle) {
                continue;
            }
            let x_at = |y: f64| a[0] + (b[0] - a[0]) * (y - a[1]) / (b[1] - a[1]);
            sides.push((x_at(middle), [x_at(front), x_at(back)], if b[1] > a[1] { 1 } else { -1 }));
        }
        sides.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut around = 0;
        for pair in sides.windows(2) {
            around += pair[0].2;
            let [left, right] = [pair[0].1[0].min(pair[0].1[1]), pair[1].1[0].max(pair[1].1[1])];
            // Lines to and fro go around nothing.
            if around == 0 || near(pair[0].0, pair[1].0) {
                continue;
            }
            match out.iter_mut().find(|r| near(r[0], left) && near(r[2], right) && near(r[3], front)) {
                Some(rectangle) => rectangle[3] = back,
                None => out.push([left, front, right, back]),
            }
        }
    }
    out
}

/// The corners that a key lists.
fn points(config: &Config, key: &str) -> Option<Vec<Point>> {
    config.points(key).filter(|points| points.len() > 2)
}

fn bed(config: &Config) -> Option<Bed> {
    let points = points(config, "bed_shape")?;
    let min = [0, 1].map(|i| points.iter().map(|p| p[i]).fold(f64::INFINITY, f64::min));
    let max = [0, 1].map(|i| points.iter().map(|p| p[i]).fold(f64::NEG_INFINITY, f64::max));
    let (size, middle) = ([0, 1].map(|i| max[i] - min[i]), [0, 1].map(|i| (min[i] + max[i]) / 2.0));
    let at_edge = |p: &Point| [0, 1].iter().all(|&i| near(p[i], min[i]) || near(p[i], max[i]));
    let on_circle = |p: &Point| near(real::hypot(p[0] - middle[0], p[1] - middle[1]), size[0] / 2.0);
    let bed = if points.len() == 4 && points.iter().all(at_edge) {
        rectangle(middle, size, false)
    } else if points.len() >= 8 && points.iter().all(on_circle) {
        disc(middle, (size[0] * 10.0).round() / 10.0, false)
    } else {
        inside(&points, middle, size)?
    };
    Some(bed)
}

/// A rectangle; its middle is named where that is the origin, else its corner.
fn rectangle(middle: Point, size: [f64; 2], is_part: bool) -> Bed {
    let centered = near(middle[0], 0.0) && near(middle[1], 0.0);
    let corner = [0, 1].map(|i| rounded(middle[i] - size[i] / 2.0));
    let corner = corner.map(|v| if near(v, 0.0) { 0.0 } else { v });
    let offset = if centered { [0.0; 2] } else { corner };
    Bed { round: false, size: size.map(rounded), centered, offset, is_part }
}

/// A disc; its corner, that of the square around it, is named where that is the origin, else its middle.
fn disc(middle: Point, diameter: f64, is_part: bool) -> Bed {
    let in_corner = middle.iter().all(|&v| near(v, diameter / 2.0));
    let near_origin = middle.iter().all(|&v| near(v, 0.0));
    let offset = if in_corner || near_origin { [0.0; 2] } else { middle.map(rounded) };
    Bed { round: true, size: [diameter; 2], centered: !in_corner, offset, is_part }
}

/// The larger of a rectangle of the outline's proportions and a disc, about its middle and inside of it.
fn inside(points: &[Point], middle: Point, size: [f64; 2]) -> Option<Bed> {
    let edges = || points.iter().zip(points.iter().cycle().skip(1)).map(|(a, b)| (*a, *b));
    if !edges().fold(false, |is, (a, b)| is != crosses(middle, a, b)) {
        return None;
    }
    let radius = edges().map(|(a, b)| distance(middle, a, b)).fold(f64::INFINITY, f64::min);
    let diameter = (20.0 * radius).floor() / 10.0;
    let half = |step: u32| size.map(|side| side / 2.0 * f64::from(step) / f64::from(STEPS));
    let free = |&step: &u32| !edges().any(|(a, b)| enters(a, b, middle, half(step)));
    let side = (1..=STEPS).rev().find(free).map(|step| half(step).map(|half| 2.0 * half));
    match side {
        Some([x, y]) if x * y >= std::f64::consts::FRAC_PI_4 * diameter * diameter => {
            Some(rectangle(middle, [x, y], true))
        }
        _ => Some(disc(middle, diameter, true)),
    }
}

/// Whether an edge crosses the ray from a point in the direction of X.
fn crosses(p: Point, a: Point, b: Point) -> bool {
    (a[1] > p[1]) != (b[1] > p[1]) && p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
}

fn distance(p: Point, a: Point, b: Point) -> f64 {
    let (d, q) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let length = d[0] * d[0] + d[1] * d[1];
    let t = if length > 0.0 { ((q[0] * d[0] + q[1] * d[1]) / length).clamp(0.0, 1.0) } else { 0.0 };
    real::hypot(q[0] - t * d[0], q[1] - t * d[1])
}

/// Whether an edge has a part inside of a rectangle.
fn enters(a: Point, b: Point, middle: Point, half: [f64; 2]) -> bool {
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    for i in 0..2 {
        let (low, high) = (middle[i] - half[i] + 1e-6, middle[i] + half[i] - 1e-6);
        let d = b[i] - a[i];
        if d == 0.0 {
            if a[i] < low || a[i] > high {
                return false;
            }
            continue;
        }
        let (t, u) = ((low - a[i]) / d, (high - a[i]) / d);
        (from, to) = (from.max(t.min(u)), to.min(t.max(u)));
    }
    from < to
}

fn of_bed(config: &Config, part: impl Fn(&Bed) -> Value) -> Outcome {
    match bed(config) {
        None => Left("is not understood, or does not hold its own middle".into()),
        Some(bed) if bed.is_part => Near(part(&bed), "beds are rectangles or discs: what fits inside".into()),
        Some(bed) => Outcome::Value(part(&bed)),
    }
}

fn numbers(values: [f64; 2]) -> Value {
    Value::Array(values.map(Value::Float).to_vec())
}

fn word(text: &str) -> Value {
    Value::String(text.into())
}

pub(super) fn shape(config: &Config) -> Outcome {
    of_bed(config, |bed| word(if bed.round { "round" } else { "rectangular" }))
}

pub(super) fn size(config: &Config) -> Outcome {
    of_bed(config, |bed| numbers(bed.size))
}

pub(super) fn origin(config: &Config) -> Outcome {
    of_bed(config, |bed| word(if bed.centered { "center" } else { "corner" }))
}

pub(super) fn offset(config: &Config) -> Outcome {
    of_bed(config, |bed| numbers(bed.offset))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(shape: &str) -> (bool, [f64; 2], bool, [f64; 2], bool) {
        let config = Config::parse(&[format!("bed_shape = {shape}")]).unwrap();
        let bed = bed(&config).unwrap();
        (bed.round, bed.size, bed.centered, bed.offset, bed.is_part)
    }

    fn circle(radius: f64, x: f64, y: f64) -> String {
        let at = (0..72).map(|i| f64::from(i) * std::f64::consts::TAU / 72.0);
        let points = at.map(|a| format!("{:.3}x{:.3}", x + radius * a.cos(), y + radius * a.sin()));
        points.collect::<Vec<_>>().join(",")
    }

    #[test]
    fn beds_are_rectangles_or_discs_wherever_they_lie() {
        let rectangle = "0x0,250x0,250x210,0x210";
        assert_eq!(of(rectangle), (false, [250.0, 210.0], false, [0.0; 2], false));
        assert_eq!(of("-90x-90,90x-90,90x90,-90x90"), (false, [180.0; 2], true, [0.0; 2], false));
        assert_eq!(of("0x0,235-0,235x235,0x235"), (false, [235.0; 2], false, [0.0; 2], false));
        assert_eq!(of("5x0,220x0,220x220,5x220"), (false, [215.0, 220.0], false, [5.0, 0.0], false));
        assert_eq!(of(&circle(100.0, 0.0, 0.0)), (true, [200.0; 2], true, [0.0; 2], false));
        assert_eq!(of(&circle(100.0, 100.0, 100.0)), (true, [200.0; 2], false, [0.0; 2], false));
        assert_eq!(of(&circle(100.0, 90.0, 110.0)), (true, [200.0; 2], true, [90.0, 110.0], false));
    }

    #[test]
    fn four_points_are_a_rectangle_in_which_nothing_is_printed() {
        let numbers = |area: &str| {
            let config = Config::parse(&[format!("bed_exclude_area = {area}")]).unwrap();
            match excluded(&config) {
                Outcome::Value(value) => value.to_string(),
                _ => String::new(),
            }
        };
        assert_eq!(numbers("0x0,18x0,18x28,0x28"), "[0.0, 0.0, 18.0, 28.0]");
        assert_eq!(numbers("0x0"), "");
        let two =
            "0x0,0x0,0x240,0x245,90x245,90x240,0x240,0x0,0x0,208x240,208x245,245x245,245x240,208x240,0x0";
        assert_eq!(numbers(two), "[0.0, 240.0, 90.0, 245.0, 208.0, 240.0, 245.0, 245.0]");
        let along_edges =
            "0x305,0x302,35x302,35x305,305x305,305x305,305x305,305x20,293x20,293x0,305x0,305x20,305x305";
        assert_eq!(numbers(along_edges), "[293.0, 0.0, 305.0, 20.0, 0.0, 302.0, 35.0, 305.0]");
    }

    #[test]
    fn of_other_outlines_a_part_is_taken() {
        // An octagon with cut corners holds a disc as wide as itself.
        let octagon = "30x0,70x0,100x30,100x70,70x100,30x100,0x70,0x30";
        assert_eq!(of(octagon), (true, [98.9; 2], true, [50.0; 2], true));
        // One corner is missing: the rectangle is about the middle of what is left.
        let (round, [x, y], _, _, is_part) = of("0x0,200x0,200x100,0x100,0x20,10x10");
        assert!(!round && is_part && x > 170.0 && y > 85.0, "{x} × {y}");
    }
}
