//! Bridges: solid infill over air, spanned by bridge lines from anchor to anchor.
//!
//! Each patch gets one direction, pieces of air near to each other together. Among those of its edges, their normals
//! and an even fan of others, it is the one in which most of the bridge lines are held at both ends, and of those that do
//! equally well the one whose longest span is the shortest.

use std::cell::LazyCell;
use std::f64::consts::PI;

use geometry::real;
use geometry::{Direction, EdgeGrid, Point, Polygon, Region};

use super::Zones;
use super::beneath::Beneath;

/// Directions tried besides those of the edges.
const FAN: u32 = 18;

/// This many of the longest edges give their directions.
const EDGES: usize = 6;

/// Lines by which a direction is judged.
const LINES: f64 = 24.0;

/// Weights of the longest and of the mean span, as a share of the longest there could be, against the share of bridge lines
/// not held.
const SPAN_WEIGHTS: [f64; 2] = [0.1, 0.01];

/// In strips of fewer bridge lines than this all lines run along the whole strip; in wider ones they are also spread
/// over the supports.
const STRIP: f64 = 6.0;

/// What is narrower than two bridge lines is bridged where it is longer than this many,
const SHORTEST_STRIP: f64 = 8.0;

/// no more than this many bridge lines wide all along, so straight,
const STRAIGHT: f64 = 2.5;

/// and can be spanned at a cost below this, nearly all of it held at both ends.
const HELD: f64 = 0.3;

/// Where a bridge line is tested for an anchor, in line widths beyond its end: over the walls beside it.
const PROBES: [f64; 4] = [0.25, 1.25, 2.25, 3.25];

/// One patch of bridge lines.
#[derive(Clone, Debug, PartialEq)]
pub struct Bridge {
    /// Where it is, what it rests on at its edges included.
    pub area: Region,
    /// Direction of the bridge lines, radians from the X axis.
    pub angle_rad: f64,
    /// Share of their length that is not held, and a little for long spans.
    pub cost: f64,
    /// Of a narrow strip of air, where it is across the bridge lines: from, to. What it rests on may be wider.
    pub strip_mm: Option<(f64, f64)>,
}

/// Takes the bridges out of an island's zones. `section` is the island, `beneath` what the layer rests on; bridge lines are
/// `width_mm` thick and reach `anchor_mm` over their anchors, inside `inside`. What is narrower than two bridge lines needs
/// no bridge, unless it is a strip that has anchors only at its ends.
pub fn take(
    zones: &mut Zones,
    inside: &Region,
    section: &Polygon,
    beneath: &Beneath<'_>,
    width_mm: f64,
    anchor_mm: f64,
) -> Vec<Bridge> {
    if zones.solid.is_empty() && zones.top.is_empty() {
        return Vec::new();
    }
    let over_air = |zone: &Region| geometry::difference(zone, beneath.region);
    let all = geometry::union(&over_air(&zones.solid), &over_air(&zones.top));
    let core = geometry::core(&all, width_mm);
    let mut air = geometry::offset(&core.region, width_mm);
    let anchors = LazyCell::new(|| Anchors { beneath, section: EdgeGrid::of(section), width_mm });
    let is_strip = |polygon: &Polygon| anchors.is_strip(&Region::from(polygon.clone()));
    let mut narrow = geometry::narrower(&all, &core, width_mm, width_mm);
    narrow.retain(|p| p.area_mm2() > SHORTEST_STRIP * width_mm * width_mm && is_strip(p));
    air.add_disjoint(narrow.into_polygons());
    if air.is_empty() {
        return Vec::new();
    }
    let taken = geometry::intersection(&geometry::offset(&air, anchor_mm), inside);
    let bridge = |polygon: &Polygon| {
        let area = Region::from(polygon.clone());
        let spanned = geometry::intersection(&air, &area);
        let (angle_rad, cost) = anchors.best_angle(&spanned);
        let (from_mm, to_mm) = Direction::of(angle_rad).extent_mm(spanned.rings().flatten());
        let strip_mm = (to_mm - from_mm < STRIP * width_mm).then_some((from_mm, to_mm));
        Bridge { area, angle_rad, cost, strip_mm }
    };
    let bridges = taken.polygons().iter().map(bridge).collect();
    zones.leave_sparse(geometry::difference(&zones.sparse, &taken));
    zones.solid = geometry::difference(&zones.solid, &taken);
    zones.top = geometry::difference(&zones.top, &taken);
    bridges
}

impl Bridge {
    /// Whether bridge lines span it, nearly all of them held at both ends.
    pub fn is_held(&self) -> bool {
        self.cost < HELD
    }
}

/// What can anchor bridge lines: where this layer lies on the one beneath.
struct Anchors<'a> {
    beneath: &'a Beneath<'a>,
    section: EdgeGrid,
    width_mm: f64,
}

impl Anchors<'_> {
    /// Whether air of less than two bridge lines' width can only be spanned along its length, from anchor to anchor.
    fn is_strip(&self, air: &Region) -> bool {
        let (angle_rad, cost) = self.best_angle(air);
        let (from_mm, to_mm) = Direction::of(angle_rad).extent_mm(air.rings().flatten());
        to_mm - from_mm < STRAIGHT * self.width_mm && cost < HELD
    }

    /// The best direction, and its cost.
    fn best_angle(&self, air: &Region) -> (f64, f64) {
        let mut angles = edge_angles(air);
        angles.extend((0..FAN).map(|k| PI * f64::from(k) / f64::from(FAN)));
        let mut best = (0.0, f64::INFINITY);
        for angle_rad in angles {
            if let Some(cost) = self.cost(air, angle_rad, best.1 - 1e-9) {
                best = (angle_rad, cost);
            }
        }
        best
    }

    /// Share of bridge line length without support at both ends (half of it counts with support at one end), plus a
    /// little for the spans; `None` if it is not below a limit.
    fn cost(&self, air: &Region, angle_rad: f64, below: f64) -> Option<f64> {
        let judged = |cost: f64| (cost < below).then_some(cost);
        let Some(bounds) = air.bounds() else { return judged(0.0) };
        let longest_mm = bounds.min.distance_mm(bounds.max);
        let (low_mm, high_mm) = Direction::of(angle_rad).extent_mm(air.rings().flatten());
        let spacing_mm = ((high_mm - low_mm) / LINES).max(self.width_mm / 2.0);
        let lines = geometry::scan_lines(air, angle_rad, spacing_mm, (low_mm + high_mm) / 2.0);
        let spans = || lines.iter().map(|line| line.ends.map(|end| end.point));
        let (mut length_mm, mut squares_mm2, mut most_mm) = (0.0, 0.0, 0.0_f64);
        for [a, b] in spans() {
            let span_mm = a.distance_mm(b);
            length_mm += span_mm;
            squares_mm2 += span_mm * span_mm;
            most_mm = most_mm.max(span_mm);
        }
        if length_mm <= 0.0 {
            return judged(f64::MAX);
        }
        let [longest, mean] = SPAN_WEIGHTS;
        let by_span = (longest * most_mm + mean * squares_mm2 / length_mm) / longest_mm;
        let (sin, cos) = real::sin_cos(angle_rad);
        let mut loose_mm = 0.0;
        for [a, b] in spans() {
            // It only becomes more.
            judged(loose_mm / length_mm + by_span)?;
            let held = usize::from(self.holds(a, [-cos, -sin])) + usize::from(self.holds(b, [cos, sin]));
            loose_mm += a.distance_mm(b) * (2 - held) as f64 / 2.0;
        }
        judged(loose_mm / length_mm + by_span)
    }

    /// Whether there is an anchor a little beyond the end of a bridge line in this direction.
    fn holds(&self, end: Point, direction: [f64; 2]) -> bool {
        PROBES.iter().any(|widths| {
            let [x, y] = direction.map(|d| d * widths * self.width_mm);
            let p = end + Point::from_mm(x, y);
            self.beneath.holds(p) && self.section.contains(p)
        })
    }
}

/// Directions of the longest edges, and their normals.
fn edge_angles(air: &Region) -> Vec<f64> {
    let outers = air.polygons().iter().map(|p| &p.outer);
    let mut edges: Vec<(i64, Point)> = outers
        .flat_map(|ring| ring.iter().zip(ring.iter().cycle().skip(1)))
        .map(|(a, b)| (a.distance2(*b), *b - *a))
        .collect();
    edges.sort_by(|a, b| b.cmp(a));
    let angle = |&(_, d): &(i64, Point)| real::atan2(f64::from(d.y), f64::from(d.x)).rem_euclid(PI);
    let along: Vec<f64> = edges.iter().take(EDGES).map(angle).collect();
    let across: Vec<f64> = along.iter().map(|a| (a + PI / 2.0).rem_euclid(PI)).collect();
    [along, across].concat()
}
