//! Vase mode: one wall in one continuously rising line, a revolution for each layer.
//!
//! A revolution follows the outline of its layer and rises by its height. So that nothing shows where one revolution ends and the
//! next begins, it glides from the outline below to its own: a vertex at a share s of the length is drawn at that share of
//! the distance from the nearest point of the outline below.

use geometry::real;
use geometry::{Bounds, EdgeGrid, Point, Polygon, Region, Ring, UNITS_PER_MM};

/// Between two outlines lines are cut into pieces of at most this.
const STEP_MM: f64 = 1.0;

/// Into how many pieces of constant flow the first and the last revolution are cut at least.
const FADE_STEPS: f64 = 64.0;

/// Share of a full line that swelling begins and fading ends with: less is not deposited on short pieces.
const LEAST_FLOW: f64 = 1.0 / 128.0;

/// Vertices nearer to each other are merged, as the amount between them would round to 0.
const CLOSE_MM: f64 = 0.02;

/// Outlines further apart than this many widths are joined by no glide: there is an edge in the surface.
const GLIDE_WIDTHS: f64 = 2.0;

/// How a layer rises as it is drawn, at one vertex of its line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rise {
    /// How far below the layer's top, in millimetres.
    pub below_mm: f64,
    /// Share of the bead's cross-section that is deposited there.
    pub flow: f64,
}

/// One revolution: a line, and how it rises.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Revolution {
    /// Vertices; the first is the last of the revolution before.
    pub points: Vec<Point>,
    /// One for each vertex.
    pub rises: Vec<Rise>,
}

/// The settings of revolutions.
#[derive(Clone, Copy, Debug)]
pub struct SpiralSpec {
    /// Width of the line.
    pub width_mm: f64,
    /// Whether revolutions glide from the outline below to their own.
    pub smooth: bool,
}

/// The middle of the wall around the largest part of a section, its holes closed; `None`: none is wide enough.
pub fn outline(section: &Region, width_mm: f64) -> Option<Ring> {
    let largest = |region: Region| {
        let rings = region.into_polygons().into_iter().map(|polygon| polygon.outer);
        rings.reduce(
            |best, ring| if geometry::ring_area(&ring) > geometry::ring_area(&best) { ring } else { best },
        )
    };
    let outer = largest(section.clone())?;
    let filled = Region::from(Polygon { outer, holes: Vec::new() });
    largest(geometry::offset(&filled, -width_mm / 2.0)).filter(|ring| ring.len() >= 3)
}

/// Makes each outline begin at the point that is nearest to where the one below it begins, the first one rearmost.
/// O(vertices).
pub fn align(outlines: &mut [Ring]) {
    let Some(mut at) = outlines.first().and_then(|ring| ring.iter().copied().max_by_key(|p| (p.y, -p.x)))
    else {
        return;
    };
    for ring in outlines {
        let edges = (0..ring.len()).map(|i| (i, closest(at, ring[i], ring[(i + 1) % ring.len()])));
        let nearest = edges.min_by(|a, b| square(a.1 - at).total_cmp(&square(b.1 - at)));
        let Some((edge, point)) = nearest else { continue };
        ring.rotate_left(edge);
        if point == ring[1] {
            ring.rotate_left(1);
        } else if point != ring[0] {
            ring.insert(1, point);
            ring.rotate_left(1);
        }
        at = point;
    }
}

/// The revolution of a layer of this height along its outline, which begins where the revolution is to begin. `below` is the
/// outline of the revolution before; `None`: it is the first, and its line swells from nothing.
pub fn revolution(
    outline: &[Point],
    below: Option<&[Point]>,
    height_mm: f64,
    spec: &SpiralSpec,
) -> Revolution {
    let first = below.is_none();
    // As in a prism, where there is nothing to glide over.
    let below = below.filter(|below| *below != outline);
    let glide = below.filter(|_| spec.smooth).map(|below| Glide::new(below, GLIDE_WIDTHS * spec.width_mm));
    let length_mm = geometry::ring_length_mm(outline).max(f64::MIN_POSITIVE);
    let step_mm = match (&glide, first) {
        (_, true) => length_mm / FADE_STEPS,
        (Some(_), _) => STEP_MM,
        (None, _) => f64::INFINITY,
    };
    let joint = below.and_then(|below| below.first().copied());
    let following = steps(outline, length_mm, step_mm).into_iter();
    let mut points: Vec<Point> = joint.into_iter().collect();
    points.extend(following.map(|(share, p)| glide.as_ref().map_or(p, |glide| glide.at(p, share))));
    Revolution::along(&points, |share| Rise {
        below_mm: (1.0 - share) * height_mm,
        flow: if first { share.max(LEAST_FLOW) } else { 1.0 },
    })
}

/// The last revolution, which levels the top: along the last outline at its height, fading to nothing.
pub fn level(outline: &[Point]) -> Revolution {
    let length_mm = geometry::ring_length_mm(outline).max(f64::MIN_POSITIVE);
    let points: Vec<Point> =
        steps(outline, length_mm, length_mm / FADE_STEPS).into_iter().map(|(_, point)| point).collect();
    Revolution::along(&points, |share| Rise { below_mm: 0.0, flow: (1.0 - share).max(LEAST_FLOW) })
}

impl Revolution {
    /// Goes on with another revolution from where this one ends.
    pub fn extend(&mut self, other: Self) {
        self.points.extend(other.points.into_iter().skip(1));
        self.rises.extend(other.rises.into_iter().skip(1));
    }

    /// A line through points (close ones left out, except ends) that rises evenly: `rise` gives the rise at a share
    /// of its length.
    fn along(points: &[Point], rise: impl Fn(f64) -> Rise) -> Self {
        let mut kept: Vec<Point> = points.first().copied().into_iter().collect();
        let mm = |a: Point, b: Point| square(a - b).sqrt() / UNITS_PER_MM;
        for &point in points {
            if kept.last().is_some_and(|last| mm(*last, point) >= CLOSE_MM) {
                kept.push(point);
            }
        }
        if let (Some(end), true) = (points.last(), kept.len() > 1) {
            kept.pop();
            kept.push(*end);
        }
        let along_mm = kept.windows(2).scan(0.0, |total_mm, w| {
            *total_mm += mm(w[0], w[1]);
            Some(*total_mm)
        });
        let along_mm: Vec<f64> = std::iter::once(0.0).chain(along_mm).collect();
        let whole_mm = along_mm.last().copied().unwrap_or_default().max(f64::MIN_POSITIVE);
        Self { points: kept, rises: along_mm.iter().map(|mm| rise(mm / whole_mm)).collect() }
    }
}

/// The vertices of a ring from its first back to it, and points between at most so far apart, each with its share of the
/// length.
fn steps(ring: &[Point], length_mm: f64, step_mm: f64) -> Vec<(f64, Point)> {
    let mut out = vec![(0.0, ring[0])];
    let mut done_mm = 0.0;
    for (i, a) in ring.iter().enumerate() {
        let (a, b) = (a.mm(), ring[(i + 1) % ring.len()].mm());
        let edge_mm = real::hypot(b[0] - a[0], b[1] - a[1]);
        let parts = (edge_mm / step_mm).ceil().clamp(1.0, 1e6) as u32;
        for part in 1..=parts {
            let share = f64::from(part) / f64::from(parts);
            let at = [0, 1].map(|k| a[k] + share * (b[k] - a[k]));
            out.push(((done_mm + share * edge_mm) / length_mm, Point::from_mm(at[0], at[1])));
        }
        done_mm += edge_mm;
    }
    out
}

/// The path from the outline below.
struct Glide {
    below: EdgeGrid,
    reach_mm: f64,
}

impl Glide {
    fn new(below: &[Point], reach_mm: f64) -> Self {
        let polygon = Polygon { outer: below.to_vec(), holes: Vec::new() };
        Self { below: EdgeGrid::of(&polygon), reach_mm }
    }

    /// A point at a share of the distance from the nearest point below; where that is too far, the point itself.
    fn at(&self, p: Point, share: f64) -> Point {
        let mut near = Vec::new();
        let reach = (self.reach_mm * UNITS_PER_MM) as i32;
        self.below.near_box(Bounds { min: p, max: p }.grown(reach), &mut near);
        let edges = near.iter().map(|&i| &self.below.edges()[i as usize]);
        let nearest = edges.map(|edge| closest(p, edge.a, edge.b));
        let nearest = nearest.min_by(|a, b| square(*a - p).total_cmp(&square(*b - p)));
        let Some(from) = nearest.filter(|q| square(*q - p).sqrt() <= f64::from(reach)) else { return p };
        let ([x, y], [px, py]) = (from.mm(), p.mm());
        Point::from_mm(x + share * (px - x), y + share * (py - y))
    }
}

fn square(p: Point) -> f64 {
    let (x, y) = (f64::from(p.x), f64::from(p.y));
    x * x + y * y
}

/// The point of a segment that is nearest to another.
pub(super) fn closest(p: Point, a: Point, b: Point) -> Point {
    let ([px, py], [ax, ay], [bx, by]) = (p.mm(), a.mm(), b.mm());
    let (dx, dy) = (bx - ax, by - ay);
    let along = ((px - ax) * dx + (py - ay) * dy) / (dx * dx + dy * dy).max(f64::MIN_POSITIVE);
    match along {
        t if t <= 0.0 => a,
        t if t >= 1.0 => b,
        t => Point::from_mm(ax + t * dx, ay + t * dy),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPEC: SpiralSpec = SpiralSpec { width_mm: 0.5, smooth: true };

    fn circle(radius_mm: f64, turned: f64) -> Ring {
        let angle = |i: u32| f64::from(i) * std::f64::consts::TAU / 180.0 + turned;
        (0..180).map(|i| Point::from_mm(radius_mm * angle(i).cos(), radius_mm * angle(i).sin())).collect()
    }

    #[test]
    fn revolutions_of_a_cone_grow_all_around() {
        let mut rings = [circle(10.0, 0.0), circle(10.3, 0.4)];
        align(&mut rings);
        let revolution = revolution(&rings[1], Some(&rings[0]), 0.2, &SPEC);
        assert_eq!((revolution.points[0], *revolution.points.last().unwrap()), (rings[0][0], rings[1][0]));
        for (point, rise) in revolution.points.iter().zip(&revolution.rises) {
            let ([x, y], share) = (point.mm(), 1.0 - rise.below_mm / 0.2);
            assert!((x.hypot(y) - (10.0 + 0.3 * share)).abs() < 0.01, "{share}: {}", x.hypot(y));
        }
        assert!(revolution.rises.windows(2).all(|w| w[1].below_mm <= w[0].below_mm));
    }

    #[test]
    fn a_prism_keeps_its_corners_and_its_start() {
        let square: Ring =
            [(0.0, 0.0), (9.0, 0.0), (9.0, 9.0), (0.0, 9.0)].map(|(x, y)| Point::from_mm(x, y)).into();
        let mut rings = vec![square.clone(), square];
        align(&mut rings);
        assert_eq!(rings[0], rings[1]);
        let revolution = revolution(&rings[1], Some(&rings[0]), 0.2, &SPEC);
        assert_eq!(revolution.points.len(), 5);
        assert_eq!(revolution.points[0], revolution.points[4]);
    }

    #[test]
    fn the_first_turn_swells_and_the_last_fades_each_holding_half() {
        let ring = circle(10.0, 0.0);
        for revolution in [revolution(&ring, None, 0.2, &SPEC), level(&ring)] {
            let flows = revolution.rises.windows(2).map(|w| (w[0].flow + w[1].flow) / 2.0);
            let edges = revolution.points.windows(2).map(|w| square(w[1] - w[0]).sqrt() / UNITS_PER_MM);
            let held: f64 = flows.zip(edges).map(|(flow, mm)| flow * mm).sum();
            assert!((held / geometry::ring_length_mm(&ring) - 0.5).abs() < 1e-3, "{held}");
        }
    }

    #[test]
    fn of_several_parts_the_largest_is_followed_and_holes_are_closed() {
        let square = |x: f64, side: f64| -> Ring {
            [(x, 0.0), (x + side, 0.0), (x + side, side), (x, side)].map(|(x, y)| Point::from_mm(x, y)).into()
        };
        let mut hole = square(2.0, 3.0);
        hole.reverse();
        let large = Polygon { outer: square(0.0, 9.0), holes: vec![hole] };
        let small = Polygon { outer: square(20.0, 4.0), holes: vec![] };
        let ring = outline(&Region::disjoint([small, large]), 0.5).unwrap();
        assert!((geometry::ring_area(&ring) - 8.5 * 8.5).abs() < 1e-6);
        assert_eq!(outline(Region::EMPTY, 0.5), None);
    }
}
