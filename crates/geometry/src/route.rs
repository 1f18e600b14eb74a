//! Routes of travels inside the part: around holes and outer walls instead of over them.
//!
//! A straight travel that stays inside is kept. Any other is led along lanes, the outline shrunk by the width of the
//! outermost wall: wherever the straight line would leave the lanes it follows their boundary, in the shorter
//! direction, to where it returns last. The result is tightened.

use std::cell::{OnceCell, RefCell};

use rustc_hash::FxHashMap;

use super::region::surrounds;
use super::{Boundary, BoundaryPos, Bounds, Edge, EdgeGrid, Point, Polygon, Region};
use super::{distance_mm, offset, polyline_length_mm, simplify, to_units};

/// How near to the outline a travel may pass, as a share of the outermost wall's width: near enough to begin and end
/// on any bead, and so far inside that no bead is dragged over the edge.
const CLEARANCE: f64 = 0.25;

/// Lanes are simplified to this share of the outermost wall's width: less than their distance from the clearance.
const ROUGH: f64 = 0.2;

/// A position further than this many widths of the outermost wall from any lane has none.
const ATTACH: f64 = 3.0;

/// A route along the lanes that is this many times too long is not tightened to see whether it would fit.
const SLACK: f64 = 2.0;

/// Passes of tightening: each sees what the one before has freed.
const PULLS: usize = 4;

/// How a travel gets from one position to another.
#[derive(Clone, Debug, PartialEq)]
pub enum Route {
    /// Inside the part, via these points (none: straight), with the total length in millimetres.
    Inside(Vec<[f64; 2]>, f64),
    /// Straight over whatever is there.
    Across,
}

/// Finds routes inside one layer. What it needs to know of the outline is computed when first needed.
#[derive(Debug)]
pub struct Router<'a> {
    outline: &'a Region,
    width_mm: f64,
    max_detour_mm: f64,
    edge: OnceCell<EdgeGrid>,
    lanes: OnceCell<Lanes>,
    /// What is known of the positions where travels begin and end.
    endpoints: RefCell<FxHashMap<Point, Endpoint>>,
}

/// Data of an endpoint of a travel.
#[derive(Clone, Copy, Debug, Default)]
struct Endpoint {
    /// Whether travels may go there at all.
    inside: Option<bool>,
    access: Option<Option<Access>>,
}

/// The boundary that detours follow.
#[derive(Debug)]
struct Lanes {
    region: Region,
    boundary: Boundary<'static>,
    grid: EdgeGrid,
    /// Which polygon each ring belongs to.
    polygon: Vec<usize>,
}

/// A point where a travel meets a lane's boundary.
#[derive(Clone, Copy, Debug)]
struct Meeting {
    /// Fraction of the distance from the start.
    t: f64,
    point: Point,
    on: BoundaryPos,
}

/// Where a travel begins or ends, as seen from the lanes.
#[derive(Clone, Copy, Debug)]
struct Access {
    point: Point,
    polygon: usize,
    /// Its position on the boundary, if it had to be moved there.
    on: Option<BoundaryPos>,
}

impl<'a> Router<'a> {
    /// A router inside `outline`, whose outermost walls are `width_mm` wide. Detours add at most `max_detour_mm` to
    /// the straight line; 0: there are none.
    pub fn new(outline: &'a Region, width_mm: f64, max_detour_mm: f64) -> Self {
        Self {
            outline,
            width_mm,
            max_detour_mm,
            edge: OnceCell::new(),
            lanes: OnceCell::new(),
            endpoints: RefCell::default(),
        }
    }

    /// The route from one position to another. O(passed cells) where the straight line is clear, else O(n) for n
    /// vertices of the lanes, and a few clearance tests.
    pub fn route(&self, from: [f64; 2], to: [f64; 2]) -> Route {
        let [a, b] = [from, to].map(|[x, y]| Point::from_mm(x, y));
        let straight_mm = distance_mm(from, to);
        if a == b {
            return Route::Inside(Vec::new(), straight_mm);
        }
        if self.clear(a, b) {
            return if self.inside(a) { Route::Inside(Vec::new(), straight_mm) } else { Route::Across };
        }
        if self.max_detour_mm <= 0.0 {
            return Route::Across;
        }
        let longest_mm = straight_mm + self.max_detour_mm;
        let Some(mut points) = self.along_lanes(a, b, SLACK * longest_mm) else { return Route::Across };
        for _ in 0..PULLS {
            let before = points.len();
            points = self.tightened(&points);
            points.reverse();
            points = self.tightened(&points);
            points.reverse();
            if points.len() == before {
                break;
            }
        }
        let length_mm = polyline_length_mm(&points);
        if length_mm > longest_mm || !points.windows(2).all(|leg| self.clear(leg[0], leg[1])) {
            return Route::Across;
        }
        let between = &points[1..points.len() - 1];
        Route::Inside(between.iter().map(|p| p.mm()).collect(), length_mm)
    }

    fn edge(&self) -> &EdgeGrid {
        self.edge.get_or_init(|| EdgeGrid::new(&offset(self.outline, -CLEARANCE * self.width_mm)))
    }

    fn lanes(&self) -> &Lanes {
        self.lanes.get_or_init(|| {
            let region = offset(self.outline, -self.width_mm);
            let region = simplify(&region, ROUGH * self.width_mm);
            let rings = |(polygon, p): (usize, &Polygon)| std::iter::repeat_n(polygon, 1 + p.holes.len());
            let polygon = region.polygons.iter().enumerate().flat_map(rings).collect();
            let boundary = Boundary::new(&region).into_owned();
            Lanes { grid: EdgeGrid::new(&region), boundary, polygon, region }
        })
    }

    /// Whether a position is inside the part, and not too near to its edge.
    fn inside(&self, p: Point) -> bool {
        let mut endpoints = self.endpoints.borrow_mut();
        *endpoints.entry(p).or_default().inside.get_or_insert_with(|| self.edge().contains(p))
    }

    /// Whether the straight line meets no edge.
    fn clear(&self, a: Point, b: Point) -> bool {
        self.edge().edges_along(a, b).all(|e| !meet([a, b], [e.a, e.b]))
    }

    /// Leaves out points of a route where the straight line between others is clear: from each, the last that a
    /// doubling, then halving step can see.
    fn tightened(&self, points: &[Point]) -> Vec<Point> {
        let mut out = vec![points[0]];
        let (mut at, last) = (0, points.len() - 1);
        while at < last {
            let sees = |i: usize| self.clear(points[at], points[i]);
            let (mut seen, mut step) = (at + 1, 1);
            while seen < last && sees((seen + step).min(last)) {
                seen = (seen + step).min(last);
                step *= 2;
            }
            while step > 1 {
                step /= 2;
                if seen + step <= last && sees(seen + step) {
                    seen += step;
                }
            }
            out.push(points[seen]);
            at = seen;
        }
        out
    }

    /// The route along the lanes, before it is tightened; `None` if there is none, or it is longer than that.
    fn along_lanes(&self, a: Point, b: Point, longest_mm: f64) -> Option<Vec<Point>> {
        let lanes = self.lanes();
        let (start, end) = (self.access(a)?, self.access(b)?);
        if start.polygon != end.polygon {
            return None;
        }
        let meetings = lanes.meetings(&start, &end);
        let mut points = vec![a, start.point];
        let mut first = 0;
        while first < meetings.len() {
            let from = meetings[first];
            let last = meetings.iter().rposition(|m| m.on.ring == from.on.ring)?;
            let to = meetings[last];
            let ahead_mm = lanes.boundary.forward_mm(from.on, to.on)?;
            let ahead = ahead_mm <= lanes.boundary.ring_length_mm(from.on.ring) / 2.0;
            points.push(from.point);
            points.extend(lanes.boundary.vertices_between(from.on, to.on, ahead));
            points.push(to.point);
            first = last + 1;
        }
        points.extend([end.point, b]);
        points.dedup();
        (polyline_length_mm(&points) <= longest_mm).then_some(points)
    }

    /// Where a position has access to the lanes: itself if it is on one, else the nearest point of a boundary.
    fn access(&self, p: Point) -> Option<Access> {
        let mut endpoints = self.endpoints.borrow_mut();
        *endpoints.entry(p).or_default().access.get_or_insert_with(|| self.find_access(p))
    }

    fn find_access(&self, p: Point) -> Option<Access> {
        let lanes = self.lanes();
        if lanes.grid.contains(p) {
            let inside =
                |polygon: &Polygon| polygon.rings().fold(false, |odd, ring| odd ^ surrounds(ring, p));
            let polygon = lanes.region.polygons.iter().position(inside)?;
            return Some(Access { point: p, polygon, on: None });
        }
        let around = Bounds { min: p, max: p }.grown(to_units(ATTACH * self.width_mm));
        let point_on = |edge: &Edge| {
            let (d, along) = (edge.b - edge.a, p - edge.a);
            let t = (along.dot(d) as f64 / (d.dot(d) as f64).max(1.0)).clamp(0.0, 1.0);
            edge.a + scaled(d, t)
        };
        let near = lanes.grid.edges_touching(around).map(|edge| (point_on(edge), edge));
        let (point, edge) = near.min_by_key(|(point, edge)| (point.distance2(p), edge.ring, edge.index))?;
        if point.distance_mm(p) > ATTACH * self.width_mm || !self.clear(p, point) {
            return None;
        }
        let on = BoundaryPos { ring: edge.ring, edge: edge.index, along_mm: edge.a.distance_mm(point) };
        Some(Access { point, polygon: lanes.polygon[edge.ring as usize], on: Some(on) })
    }
}

impl Lanes {
    /// Where the straight line meets the boundary of its polygon, in its order; ends that lie on it are the first and
    /// the last.
    fn meetings(&self, start: &Access, end: &Access) -> Vec<Meeting> {
        /// Ends on a boundary are rounded to the grid: intersections within this distance are the ends themselves.
        const SAME_MM: f64 = 1e-4;
        let (a, b) = (start.point, end.point);
        let length_mm = a.distance_mm(b);
        let mut near = Vec::new();
        self.grid.near_segment(a, b, &mut near);
        let mut meetings: Vec<Meeting> = Vec::new();
        for edge in near.iter().map(|&i| &self.grid.edges()[i as usize]) {
            let (from, to) = ((b - a).cross(edge.a - a), (b - a).cross(edge.b - a));
            if self.polygon[edge.ring as usize] != start.polygon || (from > 0) == (to > 0) {
                continue;
            }
            let share = from as f64 / (from as f64 - to as f64);
            let point = edge.a + scaled(edge.b - edge.a, share);
            let t = (point - a).dot(b - a) as f64 / ((b - a).dot(b - a) as f64).max(1.0);
            let end_mm = |on: bool| if on { SAME_MM } else { 0.0 };
            if t * length_mm < end_mm(start.on.is_some()) || (1.0 - t) * length_mm < end_mm(end.on.is_some())
            {
                continue;
            }
            let along_mm = edge.a.distance_mm(point);
            meetings.push(Meeting {
                t,
                point,
                on: BoundaryPos { ring: edge.ring, edge: edge.index, along_mm },
            });
        }
        meetings.extend(start.on.map(|on| Meeting { t: 0.0, point: a, on }));
        meetings.extend(end.on.map(|on| Meeting { t: 1.0, point: b, on }));
        meetings
            .sort_by(|m, n| m.t.total_cmp(&n.t).then((m.on.ring, m.on.edge).cmp(&(n.on.ring, n.on.edge))));
        meetings
    }
}

/// Whether two segments have a point in common.
fn meet([a, b]: [Point; 2], [c, d]: [Point; 2]) -> bool {
    let side = |a: Point, b: Point, p: Point| (b - a).cross(p - a).signum();
    let (c_side, d_side) = (side(a, b, c), side(a, b, d));
    if c_side * d_side > 0 {
        return false;
    }
    if c_side == 0 && d_side == 0 {
        // On one line: their boxes decide.
        let overlap = |a: i32, b: i32, c: i32, d: i32| a.min(b) <= c.max(d) && c.min(d) <= a.max(b);
        return overlap(a.x, b.x, c.x, d.x) && overlap(a.y, b.y, c.y, d.y);
    }
    side(c, d, a) * side(c, d, b) <= 0
}

fn scaled(d: Point, t: f64) -> Point {
    Point::new((f64::from(d.x) * t).round() as i32, (f64::from(d.y) * t).round() as i32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{self as geom, Ring};

    fn ring(points: &[(f64, f64)]) -> Ring {
        points.iter().map(|&(x, y)| Point::from_mm(x, y)).collect()
    }

    /// 40 × 20 mm with a square hole of 10 mm in its middle.
    fn frame() -> Region {
        let outer = ring(&[(0.0, 0.0), (40.0, 0.0), (40.0, 20.0), (0.0, 20.0)]);
        let hole = ring(&[(15.0, 5.0), (15.0, 15.0), (25.0, 15.0), (25.0, 5.0)]);
        Region { polygons: vec![Polygon { outer, holes: vec![hole] }] }
    }

    fn length_mm(route: &Route) -> f64 {
        match route {
            Route::Inside(_, length_mm) => *length_mm,
            Route::Across => f64::INFINITY,
        }
    }

    #[test]
    fn a_clear_route_is_straight() {
        let region = frame();
        let route = Router::new(&region, 0.45, 20.0).route([2.0, 2.0], [38.0, 3.0]);
        assert_eq!(route, Route::Inside(Vec::new(), distance_mm([2.0, 2.0], [38.0, 3.0])));
    }

    #[test]
    fn the_route_to_the_same_position_is_empty_everywhere() {
        let region = frame();
        let router = Router::new(&region, 0.45, 20.0);
        for at in (0..80).flat_map(|x| (0..40).map(move |y| [x, y].map(|half| 0.5 * f64::from(half)))) {
            assert_eq!(
                router.route(at, [at[0] + 1e-9, at[1]]),
                Route::Inside(Vec::new(), distance_mm(at, [at[0] + 1e-9, at[1]]))
            );
        }
    }

    #[test]
    fn a_hole_is_passed_on_its_nearer_side_by_the_shortest_route() {
        let region = frame();
        let router = Router::new(&region, 0.45, 20.0);
        let (from, to) = ([2.0, 11.0], [38.0, 11.0]);
        let Route::Inside(points, length) = router.route(from, to) else { panic!("there is a route") };
        // Over two corners of the lane around the hole.
        let corner = [15.0 - 0.45, 15.0 + 0.45];
        let shortest = 2.0 * distance_mm(from, corner) + 10.9;
        assert!((length - shortest).abs() < 0.05, "{length} instead of {shortest}: {points:?}");
        let on_wall = router.route([2.0, 11.0], [25.0 + 0.225, 12.0]);
        assert!(length_mm(&on_wall) < 30.0, "from an outer wall, {on_wall:?}");
    }

    #[test]
    fn no_route_leaves_the_part() {
        let teeth = (0..6).flat_map(|i| {
            let x = 6.0 * f64::from(i);
            [(x, 2.0), (x, 20.0), (x + 3.0, 20.0), (x + 3.0, 2.0)]
        });
        let comb: Vec<(f64, f64)> = teeth.chain([(33.0, 0.0), (0.0, 0.0)]).collect();
        let region = geom::unite_rings(&[ring(&comb)]);
        let router = Router::new(&region, 0.45, 200.0);
        for tooth in 1..6 {
            let x = 6.0 * f64::from(tooth) + 1.5;
            let Route::Inside(points, length) = router.route([1.5, 19.0], [x, 19.0]) else { panic!("{x}") };
            assert!(length < 2.0 * 18.0 + x + 3.0, "{length}");
            let all: Vec<Point> = std::iter::once([1.5, 19.0])
                .chain(points)
                .chain([[x, 19.0]])
                .map(|[x, y]| Point::from_mm(x, y))
                .collect();
            let pieces = geom::clip_polyline(&region, &all);
            let inside: f64 = pieces.iter().map(|p| polyline_length_mm(&p.points)).sum();
            assert!((inside - length).abs() < 1e-6, "{inside} of {length} mm inside");
        }
    }

    #[test]
    fn long_detours_and_routes_to_other_parts_go_across() {
        let mut region = frame();
        let router = Router::new(&region, 0.45, 1.0);
        assert_eq!(router.route([2.0, 10.0], [38.0, 10.0]), Route::Across);
        region.polygons[0].holes.clear();
        region.polygons.push(Polygon {
            outer: ring(&[(50.0, 0.0), (60.0, 0.0), (60.0, 20.0), (50.0, 20.0)]),
            holes: Vec::new(),
        });
        let router = Router::new(&region, 0.45, 1000.0);
        assert_eq!(router.route([2.0, 10.0], [55.0, 10.0]), Route::Across);
        assert_eq!(router.route([42.0, 10.0], [45.0, 10.0]), Route::Across, "outside of everything");
    }
}
