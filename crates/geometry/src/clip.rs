//! Polylines clipped by a region.

use super::{BoundaryPos, Edge, EdgeGrid, Point, Region, UNITS_PER_MM};

/// A part of a polyline inside a region.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ClippedPiece {
    /// Vertices, at least two, no two neighbours equal.
    pub points: Vec<Point>,
    /// Where the piece starts and ends on the region's boundary; `None` where the polyline ends inside.
    pub ends: [Option<BoundaryPos>; 2],
}

/// A region prepared to clip many polylines.
///
/// Inside means the even-odd rule over all rings. Decisions are exact: a boundary vertex on the line through
/// a segment counts as to its right, so a polyline that runs along the boundary or through its vertices is
/// cut as if it were moved to its left by less than any distance (simulation of simplicity: Edelsbrunner &
/// Mücke 1990, doi:10.1145/77635.77639). Only the resulting points are rounded to the grid.
#[derive(Clone, Debug)]
pub struct Clipper {
    grid: EdgeGrid,
}

/// A boundary crossing of one segment, at the fraction `t` of its length.
struct Cut {
    t: f64,
    point: Point,
    on: BoundaryPos,
}

/// Where a boundary edge crosses the line through a segment, seen along that line.
enum Crossing {
    Before,
    Within,
    After,
}

impl Clipper {
    /// Sorts the region's edges into a grid. O(vertices).
    pub fn new(region: &Region) -> Self {
        Self { grid: EdgeGrid::new(region) }
    }

    /// The pieces of a polyline inside the region, in its order and direction.
    ///
    /// Pieces that vanish on the grid are dropped. Give a closed curve with its first point repeated at
    /// its end. Cost grows with the cells passed, not with the size of the region.
    pub fn clip(&self, polyline: &[Point]) -> Vec<ClippedPiece> {
        let mut trace = Trace::default();
        let (mut near, mut cuts) = (Vec::new(), Vec::new());
        // Whether the last vertex is inside; unknown at the start and where a vertex is on the boundary.
        let mut inside = None;
        for pair in polyline.windows(2) {
            let (p, q) = (pair[0], pair[1]);
            if p == q {
                continue;
            }
            let touches = self.cuts(p, q, &mut near, &mut cuts);
            let mut state = match inside {
                Some(state) => state,
                None => {
                    let state = self.starts_inside(p, q, &mut near);
                    match (trace.open, state) {
                        (false, true) => trace.begin(p, self.position_of(p, &near)),
                        (true, false) => trace.end(p, self.position_of(p, &near)),
                        _ => {}
                    }
                    state
                }
            };
            for cut in &cuts {
                if state {
                    trace.end(cut.point, Some(cut.on));
                } else {
                    trace.begin(cut.point, Some(cut.on));
                }
                state = !state;
            }
            if state {
                trace.go(q);
            }
            inside = Some(state).filter(|_| !touches);
        }
        if trace.open && inside.is_none() {
            trace.last_position = polyline.last().and_then(|&q| {
                self.grid.near_segment(q, q, &mut near);
                self.position_of(q, &near)
            });
        }
        trace.finish()
    }

    /// Collects where the boundary crosses the open segment, in order; says whether `q` is on the boundary.
    fn cuts(&self, p: Point, q: Point, near: &mut Vec<u32>, cuts: &mut Vec<Cut>) -> bool {
        cuts.clear();
        let mut touches = false;
        self.grid.near_segment(p, q, near);
        for &i in near.iter() {
            let edge = &self.grid.edges()[i as usize];
            touches |= on_edge(edge, q);
            if let Some(Crossing::Within) = crossing(edge, p, q) {
                cuts.push(cut(edge, p, q));
            }
        }
        cuts.sort_by(|a, b| a.t.total_cmp(&b.t));
        touches
    }

    /// Whether the segment from `p` to `q` is inside just after its start: the parity of the crossings behind it.
    fn starts_inside(&self, p: Point, q: Point, near: &mut Vec<u32>) -> bool {
        let bounds = self.grid.bounds();
        // A point of the line behind `p` outside the box, kept within range; only its cells matter.
        let (dx, dy) = (f64::from(p.x) - f64::from(q.x), f64::from(p.y) - f64::from(q.y));
        let reach = |d: f64, from: i32, min: i32, max: i32| match d {
            d if d > 0.0 => (f64::from(max) - f64::from(from)) / d,
            d if d < 0.0 => (f64::from(min) - f64::from(from)) / d,
            _ => f64::INFINITY,
        };
        let x_reach = reach(dx, p.x, bounds.min.x, bounds.max.x);
        let y_reach = reach(dy, p.y, bounds.min.y, bounds.max.y);
        let t = x_reach.min(y_reach).max(0.0);
        let behind =
            Point::new((f64::from(p.x) + t * dx).round() as i32, (f64::from(p.y) + t * dy).round() as i32);
        self.grid.near_segment(behind, p, near);
        let before = near
            .iter()
            .filter(|&&i| matches!(crossing(&self.grid.edges()[i as usize], p, q), Some(Crossing::Before)))
            .count();
        before % 2 == 1
    }

    /// The position of a point that is on one of the given edges.
    fn position_of(&self, p: Point, near: &[u32]) -> Option<BoundaryPos> {
        let edge = near.iter().map(|&i| &self.grid.edges()[i as usize]).find(|e| on_edge(e, p))?;
        Some(BoundaryPos { ring: edge.ring, edge: edge.index, along_mm: edge.a.distance_mm(p) })
    }
}

/// The pieces of one polyline inside a region; see [`Clipper::clip`], which this makes ready each time.
pub fn clip_polyline(region: &Region, polyline: &[Point]) -> Vec<ClippedPiece> {
    Clipper::new(region).clip(polyline)
}

/// The parts of segments inside a region, in the order and direction of the segments.
pub fn clip_segments(region: &Region, segments: &[[Point; 2]]) -> Vec<ClippedPiece> {
    let clipper = Clipper::new(region);
    segments.iter().flat_map(|segment| clipper.clip(segment)).collect()
}

/// Length of an open polyline in millimetres.
pub fn polyline_length_mm(polyline: &[Point]) -> f64 {
    polyline.windows(2).map(|e| e[0].distance_mm(e[1])).sum()
}

/// The pieces found so far; the last one is still growing while `open`.
#[derive(Default)]
struct Trace {
    pieces: Vec<ClippedPiece>,
    open: bool,
    last_position: Option<BoundaryPos>,
}

impl Trace {
    /// Starts a piece, or continues with the last one if that ended here.
    fn begin(&mut self, at: Point, on: Option<BoundaryPos>) {
        self.open = true;
        if self.pieces.last().and_then(|piece| piece.points.last()) != Some(&at) {
            self.drop_point();
            self.pieces.push(ClippedPiece { points: vec![at], ends: [on, None] });
        }
    }

    fn go(&mut self, to: Point) {
        if let Some(piece) = self.pieces.last_mut().filter(|piece| piece.points.last() != Some(&to)) {
            piece.points.push(to);
        }
    }

    fn end(&mut self, at: Point, on: Option<BoundaryPos>) {
        self.go(at);
        self.open = false;
        if let Some(piece) = self.pieces.last_mut() {
            piece.ends[1] = on;
        }
    }

    /// Forgets the last piece if it is a single point.
    fn drop_point(&mut self) {
        if self.pieces.last().is_some_and(|piece| piece.points.len() < 2) {
            self.pieces.pop();
        }
    }

    fn finish(mut self) -> Vec<ClippedPiece> {
        if let Some(piece) = self.pieces.last_mut().filter(|_| self.open) {
            piece.ends[1] = self.last_position;
        }
        self.drop_point();
        self.pieces
    }
}

fn side(a: Point, b: Point, p: Point) -> i64 {
    (b - a).cross(p - a)
}

fn on_edge(edge: &Edge, p: Point) -> bool {
    let (a, b) = (edge.a, edge.b);
    (a.x.min(b.x)..=a.x.max(b.x)).contains(&p.x)
        && (a.y.min(b.y)..=a.y.max(b.y)).contains(&p.y)
        && side(a, b, p) == 0
}

/// Where the edge crosses the line through `p` and `q`, or `None`: edge ends on the line count as to the right of it.
/// A crossing at `p` is before, one at `q` after the segment.
fn crossing(edge: &Edge, p: Point, q: Point) -> Option<Crossing> {
    if (side(p, q, edge.a) > 0) == (side(p, q, edge.b) > 0) {
        return None;
    }
    let (at_p, at_q) = (side(edge.a, edge.b, p), side(edge.a, edge.b, q));
    Some(if at_p == 0 {
        Crossing::Before
    } else if at_q == 0 {
        Crossing::After
    } else if (at_p > 0) != (at_q > 0) {
        Crossing::Within
    } else if at_p.unsigned_abs() < at_q.unsigned_abs() {
        Crossing::Before
    } else {
        Crossing::After
    })
}

fn cut(edge: &Edge, p: Point, q: Point) -> Cut {
    let (at_p, at_q) = (side(edge.a, edge.b, p) as f64, side(edge.a, edge.b, q) as f64);
    let t = at_p / (at_p - at_q);
    let lerp = |a: i32, b: i32| (f64::from(a) + t * (f64::from(b) - f64::from(a))).round() as i32;
    let point = Point::new(lerp(p.x, q.x), lerp(p.y, q.y));
    let along_mm = edge.a.distance_mm(point).min((edge.b.distance2(edge.a) as f64).sqrt() / UNITS_PER_MM);
    Cut { t, point, on: BoundaryPos { ring: edge.ring, edge: edge.index, along_mm } }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Polygon, Ring, scan_lines};
    use proptest::prelude::*;

    fn ring(points: &[(i32, i32)]) -> Ring {
        points.iter().map(|&(x, y)| Point::new(x, y)).collect()
    }

    fn frame() -> Region {
        let outer = ring(&[(0, 0), (1000, 0), (1000, 1000), (0, 1000)]);
        let hole = ring(&[(400, 400), (400, 600), (600, 600), (600, 400)]);
        Region { polygons: vec![Polygon { outer, holes: vec![hole] }] }
    }

    fn clipped(line: &[(i32, i32)]) -> Vec<Ring> {
        clip_polyline(&frame(), &ring(line)).into_iter().map(|piece| piece.points).collect()
    }

    #[test]
    fn a_line_is_cut_at_outline_and_hole() {
        let pieces = clip_polyline(&frame(), &ring(&[(-100, 500), (1100, 500)]));
        let points: Vec<&Ring> = pieces.iter().map(|piece| &piece.points).collect();
        assert_eq!(points, [&ring(&[(0, 500), (400, 500)]), &ring(&[(600, 500), (1000, 500)])]);
        let positions = pieces[0].ends.map(|end| end.map(|on| (on.ring, on.edge)));
        assert_eq!(positions, [Some((0, 3)), Some((1, 0))]);
    }

    #[test]
    fn an_inner_polyline_stays_whole() {
        let line = ring(&[(100, 100), (200, 300), (300, 100), (300, 900)]);
        let pieces = clip_polyline(&frame(), &line);
        assert_eq!(pieces, [ClippedPiece { points: line, ends: [None, None] }]);
    }

    #[test]
    fn vertices_on_the_boundary_do_not_confuse() {
        assert_eq!(clipped(&[(-50, 0), (0, 0), (500, 200), (1000, 0), (1050, 0)]).len(), 1);
        assert_eq!(clipped(&[(500, -50), (500, 0), (450, 400), (450, 500), (450, 600), (450, 700)]).len(), 2);
        // Touching the hole's corner from outside the hole.
        assert_eq!(clipped(&[(300, 500), (500, 300)]).len(), 1);
        assert_eq!(clipped(&[(300, 500), (400, 400), (500, 300)]).len(), 1);
        assert!(clipped(&[(500, 500), (400, 400), (400, 500)]).iter().all(|p| p.len() == 2));
    }

    #[test]
    fn ends_on_the_boundary_are_placed() {
        let pieces = clip_polyline(&frame(), &ring(&[(0, 100), (100, 100), (400, 500)]));
        assert_eq!(pieces.len(), 1);
        assert_eq!(pieces[0].ends.map(|end| end.map(|on| (on.ring, on.edge))), [Some((0, 3)), Some((1, 0))]);
    }

    /// A comb-like simple polygon: teeth of random height over a base line.
    fn comb() -> impl Strategy<Value = Region> {
        prop::collection::vec((1_i32..900, 1_i32..60), 3..40).prop_map(|teeth| {
            let mut outer = vec![Point::new(0, -100)];
            let mut x = 0;
            let mut top = Vec::new();
            for (height, step) in teeth {
                top.push(Point::new(x, height));
                x += step;
            }
            outer.push(Point::new(x, -100));
            outer.extend(top.into_iter().rev());
            Region { polygons: vec![Polygon { outer, holes: vec![] }] }
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(256))]

        #[test]
        fn pieces_and_gaps_make_the_line(region in comb(), line in prop::collection::vec((-100_i32..1500, -200_i32..1000), 2..12)) {
            let line = ring(&line);
            let pieces = clip_polyline(&region, &line);
            let total: f64 = pieces.iter().map(|piece| polyline_length_mm(&piece.points)).sum();
            // Sampled: the share of points of the line that are inside.
            let mut inside_mm = 0.0;
            for pair in line.windows(2) {
                let hits = (0..400).filter(|i| {
                    let t = (f64::from(*i) + 0.5) / 400.0;
                    let lerp = |a: i32, b: i32| (f64::from(a) + t * f64::from(b - a)).round() as i32;
                    region.contains(Point::new(lerp(pair[0].x, pair[1].x), lerp(pair[0].y, pair[1].y)))
                });
                inside_mm += hits.count() as f64 / 400.0 * pair[0].distance_mm(pair[1]);
            }
            let slack = 0.03 * polyline_length_mm(&line) + 1e-4;
            prop_assert!((total - inside_mm).abs() < slack, "{total} {inside_mm}");
        }

        #[test]
        fn clipping_a_level_line_is_hatching(region in comb(), y in -150_i32..950) {
            let line = [Point::new(-500, y), Point::new(3000, y)];
            let clipped: f64 = clip_polyline(&region, &line).iter().map(|p| polyline_length_mm(&p.points)).sum();
            let spacing_mm = 100.0;
            let hatched: f64 = scan_lines(&region, 0.0, spacing_mm, f64::from(y) / UNITS_PER_MM)
                .iter()
                .map(|part| part.ends[0].point.distance_mm(part.ends[1].point))
                .sum();
            // A level edge may belong to either side.
            let level: f64 = region.polygons[0].outer.windows(2)
                .filter(|e| e[0].y == y && e[1].y == y).map(|e| e[0].distance_mm(e[1])).sum();
            prop_assert!((clipped - hatched).abs() <= level + 3e-4, "{clipped} {hatched}");
        }
    }
}
