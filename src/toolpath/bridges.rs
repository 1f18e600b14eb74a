//! Bridges: solid infill over air, spanned by threads from hold to hold.
//!
//! Each patch gets one direction, pieces of air near to each other together. Among those of its edges, their normals
//! and an even fan of others, it is the one in which most of the threads are held at both ends, and of those that do
//! equally well the one whose longest span is the shortest.

use std::f64::consts::PI;

use crate::geom::{self, EdgeGrid, Point, Polygon, Region};

use super::Zones;

/// Directions tried besides those of the edges.
const FAN: u32 = 18;

/// So many of the longest edges give their directions.
const EDGES: usize = 6;

/// Lines by which a direction is judged.
const LINES: f64 = 24.0;

/// Weights of the longest and of the mean span, as a share of the longest there could be, against the share of threads
/// not held.
const SPAN_WEIGHTS: [f64; 2] = [0.1, 0.01];

/// Where a thread is looked for hold, in thread widths beyond its end: over the walls beside it.
const PROBES: [f64; 4] = [0.25, 1.25, 2.25, 3.25];

/// One patch of threads.
#[derive(Clone, Debug, PartialEq)]
pub struct Bridge {
    /// Where it is, what it rests on at its edges included.
    pub area: Region,
    /// Direction of the threads, radians from the X axis.
    pub angle_rad: f64,
}

/// Takes the bridges out of an island's zones. `section` is the island, `beneath` what the layer rests on; threads are
/// `width_mm` thick and reach `anchor_mm` over their hold, inside of `inside`. What is narrower than two threads needs
/// no bridge.
pub fn take(
    zones: &mut Zones,
    inside: &Region,
    section: &Polygon,
    beneath: &Region,
    width_mm: f64,
    anchor_mm: f64,
) -> Vec<Bridge> {
    if zones.solid.is_empty() && zones.top.is_empty() {
        return Vec::new();
    }
    let over_air = |zone: &Region| geom::difference(zone, beneath);
    let air = geom::union(&over_air(&zones.solid), &over_air(&zones.top));
    let air = geom::opening(&air, width_mm);
    if air.is_empty() {
        return Vec::new();
    }
    let hold = Hold {
        beneath: EdgeGrid::new(beneath),
        section: EdgeGrid::new(&Region { polygons: vec![section.clone()] }),
        width_mm,
    };
    let taken = geom::intersection(&geom::offset(&air, anchor_mm), inside);
    let bridge = |polygon: &Polygon| {
        let area = Region { polygons: vec![polygon.clone()] };
        let spanned = geom::intersection(&air, &area);
        Bridge { angle_rad: hold.best_angle(&spanned), area }
    };
    let bridges = taken.polygons.iter().map(bridge).collect();
    let sparse = geom::difference(&zones.sparse, &taken);
    zones.sparse_mm2 = (zones.sparse_mm2 - (zones.sparse.area_mm2() - sparse.area_mm2())).max(0.0);
    zones.sparse = sparse;
    zones.solid = geom::difference(&zones.solid, &taken);
    zones.top = geom::difference(&zones.top, &taken);
    bridges
}

/// What can hold threads: where this layer lies on the one beneath.
struct Hold {
    beneath: EdgeGrid,
    section: EdgeGrid,
    width_mm: f64,
}

impl Hold {
    fn best_angle(&self, air: &Region) -> f64 {
        let mut angles = edge_angles(air);
        angles.extend((0..FAN).map(|k| PI * f64::from(k) / f64::from(FAN)));
        let mut best = (f64::INFINITY, 0.0);
        for angle_rad in angles {
            if let Some(cost) = self.cost(air, angle_rad, best.0 - 1e-9) {
                best = (cost, angle_rad);
            }
        }
        best.1
    }

    /// Share of thread that is not held at both ends (half of it counts where one end is), and a little for the spans;
    /// `None` where that is not below a limit.
    fn cost(&self, air: &Region, angle_rad: f64, below: f64) -> Option<f64> {
        let judged = |cost: f64| (cost < below).then_some(cost);
        let Some(bounds) = air.bounds() else { return judged(0.0) };
        let longest_mm = bounds.min.distance_mm(bounds.max);
        let spacing_mm = (longest_mm / LINES).max(self.width_mm / 2.0);
        let lines = geom::scan_lines(air, angle_rad, spacing_mm, 0.0);
        let spans = || lines.iter().flat_map(|line| &line.segments).map(|[a, b]| [a.point, b.point]);
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
        let (sin, cos) = angle_rad.sin_cos();
        let mut loose_mm = 0.0;
        for [a, b] in spans() {
            // It only becomes more.
            judged(loose_mm / length_mm + by_span)?;
            let held = usize::from(self.holds(a, [-cos, -sin])) + usize::from(self.holds(b, [cos, sin]));
            loose_mm += a.distance_mm(b) * (2 - held) as f64 / 2.0;
        }
        judged(loose_mm / length_mm + by_span)
    }

    /// Whether there is hold a little beyond the end of a thread that runs this way.
    fn holds(&self, end: Point, way: [f64; 2]) -> bool {
        PROBES.iter().any(|widths| {
            let [x, y] = way.map(|w| w * widths * self.width_mm);
            let p = end + Point::from_mm(x, y);
            self.beneath.contains(p) && self.section.contains(p)
        })
    }
}

/// Directions of the longest edges, and their normals.
fn edge_angles(air: &Region) -> Vec<f64> {
    let outers = air.polygons.iter().map(|p| &p.outer);
    let mut edges: Vec<(i64, Point)> = outers
        .flat_map(|ring| ring.iter().zip(ring.iter().cycle().skip(1)))
        .map(|(a, b)| (a.distance2(*b), *b - *a))
        .collect();
    edges.sort_by(|a, b| b.cmp(a));
    let angle = |&(_, d): &(i64, Point)| f64::from(d.y).atan2(f64::from(d.x)).rem_euclid(PI);
    let along: Vec<f64> = edges.iter().take(EDGES).map(angle).collect();
    let across: Vec<f64> = along.iter().map(|a| (a + PI / 2.0).rem_euclid(PI)).collect();
    [along, across].concat()
}
