//! What the beads of a part leave of it, where it is to be solid.
//!
//! Parts of different tools have narrow and bent rooms, in which walls, patches of solid infill and single beads meet at all angles.
//! What lies between them shows only when all are there.

use geometry::{Point, Polygon, Region, Ring, real};

use super::bead;
use super::beading::{self, Gap};
use super::path::Path;

/// Smaller places are not worth the travel to them, mm².
const SMALLEST_MM2: f64 = 0.02;

/// What is narrower is no part of them, mm: a bead's ends, which do not reach into tips, hold what is open there.
const NARROWEST_MM: f64 = 0.1;

/// Flatter turns leave nothing open beside them: cosine of 15°.
const FLAT: f64 = 0.966;

/// Corners of the polygon that stands for the round outside of a turn.
const TURN_CORNERS: u32 = 8;

/// A place between beads.
pub(super) struct Place {
    /// Where a single bead fits.
    pub gap: Gap,
    /// Area of the place, with the corners that a bead does not reach.
    pub open_mm2: f64,
}

/// Where single beads fit between the others in an area.
pub(super) fn find(area: &Region, paths: &[Path]) -> Vec<Place> {
    if area.is_empty() {
        return Vec::new();
    }
    let covered: Vec<Ring> = paths.iter().flat_map(rings).collect();
    let open = geometry::difference(area, &geometry::unite_rings(&covered));
    let wide = geometry::opening(&open, NARROWEST_MM / 2.0);
    let places = wide.polygons().iter().filter(|polygon| polygon.area_mm2() >= SMALLEST_MM2);
    let place = |polygon: &Polygon| {
        let region = Region::from(polygon.clone());
        let around = geometry::offset(&region, beading::MIN_GAP_MM);
        let open_mm2 = geometry::intersection(&open, &around).area_mm2();
        Place { gap: Gap { area: region.clone(), region }, open_mm2 }
    };
    places.map(place).collect()
}

/// What a bead covers with its spacing: a ring for each line, and one for each turn.
fn rings(path: &Path) -> Vec<Ring> {
    let count = path.points.len();
    let rounding_mm = bead::rounding_mm(path.height_mm);
    let half_mm = |k: usize| ((path.width.at_mm(k) - rounding_mm) / 2.0).max(0.0);
    let lines = if path.closed { count } else { count - 1 };
    let mut rings = Vec::with_capacity(lines);
    let mut before: Option<[f64; 2]> = None;
    let way = |k: usize| {
        let [a, b] = [path.points[k].mm(), path.points[(k + 1) % count].mm()];
        let length_mm = geometry::distance_mm(a, b);
        (length_mm > 0.0).then(|| [0, 1].map(|i| (b[i] - a[i]) / length_mm))
    };
    if path.closed {
        before = way(count - 1);
    }
    for k in 0..lines {
        let Some(along) = way(k) else { continue };
        let next = (k + 1) % count;
        let corner = |at: usize, side: f64| {
            let [x, y] = path.points[at].mm();
            Point::from_mm(x - side * half_mm(at) * along[1], y + side * half_mm(at) * along[0])
        };
        rings.push(vec![corner(k, -1.0), corner(next, -1.0), corner(next, 1.0), corner(k, 1.0)]);
        if before.is_some_and(|before| before[0] * along[0] + before[1] * along[1] < FLAT) {
            rings.push(round(path.points[k], half_mm(k)));
        }
        before = Some(along);
    }
    rings
}

/// A polygon about a point.
fn round(at: Point, radius_mm: f64) -> Ring {
    let [x, y] = at.mm();
    let corner = |k: u32| {
        let (sine, cosine) = real::sin_cos(f64::from(k) * std::f64::consts::TAU / f64::from(TURN_CORNERS));
        Point::from_mm(x + radius_mm * cosine, y + radius_mm * sine)
    };
    (0..TURN_CORNERS).map(corner).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::toolpath::{Phase, Role, Width};

    const HEIGHT_MM: f64 = 0.2;
    const SPACING_MM: f64 = 0.4;

    fn bead(corners: &[[f64; 2]]) -> Path {
        Path {
            role: Role::SolidInfill,
            closed: false,
            points: corners.iter().map(|[x, y]| Point::from_mm(*x, *y)).collect(),
            width: Width::Constant(bead::width_mm(SPACING_MM, HEIGHT_MM)),
            height_mm: HEIGHT_MM,
            island: None,
            phase: Phase::Inside,
            tool: None,
        }
    }

    fn region(corners: &[[f64; 2]]) -> Region {
        let outer = corners.iter().map(|[x, y]| Point::from_mm(*x, *y)).collect();
        Region::from(Polygon { outer, holes: Vec::new() })
    }

    #[test]
    fn lines_side_by_side_leave_nothing() {
        let lines: Vec<Path> = (0..5)
            .map(|k| 0.2 + SPACING_MM * f64::from(k))
            .map(|y_mm| bead(&[[0.0, y_mm], [10.0, y_mm]]))
            .collect();
        assert_eq!(find(&region(&[[0.0, 0.0], [10.0, 0.0], [10.0, 2.0], [0.0, 2.0]]), &lines).len(), 0);
        // Nor does one line that turns at each end, but in the corners outside of its turns, which are small.
        let line = bead(&[[0.0, 0.2], [9.8, 0.2], [9.8, 0.6], [0.2, 0.6], [0.2, 1.0], [10.0, 1.0]]);
        assert_eq!(find(&region(&[[0.0, 0.0], [10.0, 0.0], [10.0, 1.2], [0.0, 1.2]]), &[line]).len(), 0);
    }

    #[test]
    fn a_wedge_between_two_lines_is_left_as_far_as_a_bead_fits_into_it() {
        // From nothing to 0.5 mm wide.
        let lines = [bead(&[[0.0, 0.2], [10.0, 0.2]]), bead(&[[0.0, 0.6], [10.0, 1.1]])];
        let places = find(&region(&[[0.0, 0.0], [10.0, 0.0], [10.0, 1.3], [0.0, 0.8]]), &lines);
        let [Place { gap, open_mm2 }] = places.as_slice() else { panic!("{} places", places.len()) };
        let [polygon] = gap.area.polygons() else { panic!("{:?}", gap.area) };
        let reach = polygon.outer.iter().map(|point| point.mm()[0]).fold(f64::INFINITY, f64::min);
        assert!(
            (1.5..2.25).contains(&reach),
            "it begins at {reach} mm, where the wedge is {} mm wide",
            reach / 20.0
        );
        assert!((gap.area.area_mm2() - 2.46).abs() < 0.1, "{} mm²", gap.area.area_mm2());
        assert!((2.35..2.52).contains(open_mm2), "{open_mm2} mm²");
    }
}
