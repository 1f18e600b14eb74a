//! Which overhangs can be bridged.

use std::f64::consts::PI;

use super::bitmap::Bitmap;
use geometry::real;
use geometry::{HatchSegment, Point, Region};

/// Directions that are tried over half a turn.
const DIRECTIONS: u32 = 12;

/// Distance between the lines that stand for beads.
const LINE_MM: f64 = 0.6;

/// How far into what carries them bridges are anchored, at least.
const ANCHOR_MM: f64 = 0.6;

/// Bridges may be longer by this: their ends are known no better.
const SLACK_MM: f64 = 0.1;

/// Where less than this share of an overhang is spanned it is no bridge.
const LEAST_SHARE: f64 = 0.5;

/// The cells of an overhang that straight beads in the best of some directions span from `carrier` to `carrier`, each
/// at most `longest_mm` long.
pub fn spanned(overhang: &Region, carrier: &Bitmap, longest_mm: f64) -> Bitmap {
    let none = Bitmap::empty(carrier.grid());
    let Some(bounds) = overhang.bounds() else { return none };
    let (min, max) = (bounds.min.mm(), bounds.max.mm());
    // Too small to be a bridge: a rim.
    if longest_mm <= 0.0 || (max[0] - min[0]).max(max[1] - min[1]) < 2.0 * ANCHOR_MM {
        return none;
    }
    let spans = |k: u32| {
        let angle_rad = f64::from(k) * PI / f64::from(DIRECTIONS);
        let (sin, cos) = real::sin_cos(angle_rad);
        let (mut held, mut all_mm, mut held_mm) = (Vec::new(), 0.0, 0.0);
        for HatchSegment { ends: [a, b], .. } in geometry::scan_lines(overhang, angle_rad, LINE_MM, 0.0) {
            let length_mm = a.point.distance_mm(b.point);
            let beyond = |p: Point, by_mm: f64| {
                let [x, y] = p.mm();
                carrier.has_at(Point::from_mm(x + by_mm * cos, y + by_mm * sin))
            };
            all_mm += length_mm;
            if length_mm <= longest_mm + SLACK_MM && beyond(a.point, -ANCHOR_MM) && beyond(b.point, ANCHOR_MM)
            {
                held_mm += length_mm;
                held.push([a.point, b.point]);
            }
        }
        (held_mm / f64::max(all_mm, 1e-9), held)
    };
    let best =
        (0..DIRECTIONS).map(spans).reduce(|best, next| if next.0 > best.0 + 1e-9 { next } else { best });
    match best {
        Some((share, held)) if share >= LEAST_SHARE => stroked(&held, carrier),
        _ => none,
    }
}

/// The cells that beads cover.
fn stroked(lines: &[[Point; 2]], like: &Bitmap) -> Bitmap {
    let mut map = Bitmap::empty(like.grid());
    let step_mm = map.grid().cell_mm() / 2.0;
    for [a, b] in lines {
        let (a, b) = (a.mm(), b.mm());
        let steps = (real::hypot(b[0] - a[0], b[1] - a[1]) / step_mm).ceil().max(1.0);
        for k in 0..=steps as usize {
            let t = k as f64 / steps;
            let p = Point::from_mm(a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]));
            if let Some(cell) = map.grid().cell_at(p) {
                map.set(cell);
            }
        }
    }
    map.grown(1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::toolpath::support::bitmap::Grid;
    use geometry::{Bounds, Polygon};

    fn rectangle(x0: f64, y0: f64, x1: f64, y1: f64) -> Region {
        let outer = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)].map(|(x, y)| Point::from_mm(x, y)).to_vec();
        Region::from(Polygon { outer, holes: Vec::new() })
    }

    fn carrier(parts: &[Region]) -> Bitmap {
        let bounds = Bounds { min: Point::from_mm(0.0, 0.0), max: Point::from_mm(50.0, 20.0) };
        let mut map = Bitmap::empty(Grid::new(bounds, 1.0, 0.4));
        parts.iter().for_each(|part| map.add(&Bitmap::of(map.grid(), part)));
        map
    }

    #[test]
    fn a_gap_between_two_piers_is_bridged_if_it_is_short() {
        let piers = carrier(&[rectangle(0.0, 0.0, 10.0, 10.0), rectangle(18.0, 0.0, 30.0, 10.0)]);
        let gap = rectangle(10.0, 0.0, 18.0, 10.0);
        let mut cells = Bitmap::of(piers.grid(), &gap);
        cells.remove(&spanned(&gap, &piers, 10.0));
        assert!(cells.is_empty());
        assert!(spanned(&gap, &piers, 7.0).is_empty());
    }

    #[test]
    fn a_ledge_held_on_one_side_is_no_bridge() {
        let pier = carrier(&[rectangle(0.0, 0.0, 10.0, 10.0)]);
        assert!(spanned(&rectangle(10.0, 0.0, 16.0, 10.0), &pier, 10.0).is_empty());
    }
}
