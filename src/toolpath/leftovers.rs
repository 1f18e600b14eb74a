//! What the beads of an island leave of it, where it is to be solid.
//!
//! In narrow and bent rooms walls, patches of solid infill, bridge lines and single beads meet at all angles. What lies between
//! them shows only when all are there. Where that is, cells tell in a moment; what it looks like, exact outlines.

use geometry::{Bounds, Boxes, Point, Polygon, Region, Ring, real, to_units};

use super::Role;
use super::bead;
use super::beading::{self, Gap};
use super::path::Path;
use super::support::{self, Grid, Within};

/// Side of a cell, as a share of that of a square as large as the smallest place.
const CELL: f64 = 0.45;

/// As many cells as a place shows at least: those at the edge of an area count as covered.
const FEWEST: usize = 2;

/// Areas have at most so many cells along a side: 8 MB.
const MOST_CELLS: f64 = 8192.0;

/// To cells, beads are so much wider on both sides: those side by side leave none.
const WIDER_MM: f64 = 0.02;

/// Places reach so far around the cells that no bead covers.
const AROUND_MM: f64 = 0.2;

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

/// What is to be solid.
pub(super) struct Room<'a> {
    /// Areas that do not overlap.
    pub areas: &'a [&'a Region],
    /// Sparse infill, beside which nothing is filled,
    pub sparse: &'a Region,
    /// no further than this.
    pub beside_mm: f64,
    /// Smaller places are not worth the travel to them.
    pub smallest_mm2: f64,
}

/// Where single beads fit between others.
pub(super) fn find<'a>(room: &Room<'_>, paths: impl Iterator<Item = &'a Path> + Clone) -> Vec<Place> {
    let near = room.near(paths.clone());
    if near.is_empty() {
        return Vec::new();
    }
    let boxes = Boxes::of(&near);
    let is_near = |ring: &Ring| {
        Bounds::of(ring.iter().copied()).is_some_and(|bounds| !boxes.touching(&bounds).is_empty())
    };
    let covered: Vec<Ring> = paths.flat_map(|path| rings(path, 0.0)).filter(is_near).collect();
    let open = geometry::difference(&room.within(&near), &geometry::unite_rings(&covered));
    let wide = geometry::opening(&open, NARROWEST_MM / 2.0);
    let places = wide.polygons().iter().filter(|polygon| polygon.area_mm2() >= room.smallest_mm2);
    let place = |polygon: &Polygon| {
        let region = Region::from(polygon.clone());
        let around = geometry::offset(&region, beading::MIN_GAP_MM);
        let open_mm2 = geometry::intersection(&open, &around).area_mm2();
        Place { gap: Gap { area: region.clone(), region }, open_mm2 }
    };
    places.map(place).collect()
}

impl Room<'_> {
    /// Around cells that no bead covers, where these are enough for a place.
    fn near<'a>(&self, paths: impl Iterator<Item = &'a Path>) -> Region {
        let all = self.areas.iter().filter_map(|area| area.bounds()).reduce(|a, b| a.joined(&b));
        let Some(bounds) = all else { return Region::default() };
        let cell_mm = CELL * self.smallest_mm2.sqrt();
        let grid = Grid::of_at_most(MOST_CELLS, bounds, 2.0 * cell_mm, cell_mm);
        let is_beside = |path: &&Path| {
            let half_mm = path.width.widest_mm() / 2.0 + WIDER_MM;
            let reach = Bounds::of(path.points.iter().copied()).map(|line| line.grown(to_units(half_mm)));
            reach.is_some_and(|reach| reach.touches(&bounds))
        };
        let covered: Vec<Ring> = paths.filter(is_beside).flat_map(|path| rings(path, WIDER_MM)).collect();
        let mut near = Vec::new();
        for area in self.areas.iter().filter(|area| !area.is_empty()) {
            let mut open = Within::of(grid, area).into_cells();
            covered.iter().for_each(|ring| open.remove_convex(ring));
            open.remove_small(FEWEST);
            if !open.is_empty() {
                near.push(support::trace(&open.grown(grid.cells(AROUND_MM))));
            }
        }
        geometry::union_all(&near)
    }

    /// What of it lies near.
    fn within(&self, near: &Region) -> Region {
        let close = |area: &Region| geometry::intersection(area, near);
        let areas: Vec<Region> = self.areas.iter().map(|area| close(area)).collect();
        let sparse = geometry::intersection(self.sparse, &geometry::offset(near, self.beside_mm));
        geometry::difference(&geometry::union_all(&areas), &geometry::offset(&sparse, self.beside_mm))
    }
}

/// What a bead covers with its spacing, and so much beside it: convex rings, one for each line and for each turn.
fn rings(path: &Path, more_mm: f64) -> Vec<Ring> {
    let count = path.points.len();
    // Threads in air lie as far apart as they are wide.
    let is_thread = path.role == Role::BridgeInfill;
    let rounding_mm = if is_thread { 0.0 } else { bead::rounding_mm(path.height_mm) };
    let half_mm = |k: usize| (path.width.at_mm(k) - rounding_mm).max(0.0) / 2.0 + more_mm;
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
    use crate::toolpath::{Phase, Width};

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

    fn places(area: &Region, paths: &[Path]) -> Vec<Place> {
        let sparse = Region::default();
        find(
            &Room { areas: &[area], sparse: &sparse, beside_mm: SPACING_MM, smallest_mm2: 0.02 },
            paths.iter(),
        )
    }

    #[test]
    fn lines_side_by_side_leave_nothing() {
        let lines: Vec<Path> = (0..5)
            .map(|k| 0.2 + SPACING_MM * f64::from(k))
            .map(|y_mm| bead(&[[0.0, y_mm], [10.0, y_mm]]))
            .collect();
        let strip = |depth_mm: f64| region(&[[0.0, 0.0], [10.0, 0.0], [10.0, depth_mm], [0.0, depth_mm]]);
        assert_eq!(places(&strip(2.0), &lines).len(), 0);
        // Nor does one line that turns at each end, but in the corners outside of its turns, which are small.
        let line = bead(&[[0.0, 0.2], [9.8, 0.2], [9.8, 0.6], [0.2, 0.6], [0.2, 1.0], [10.0, 1.0]]);
        assert_eq!(places(&strip(1.2), &[line]).len(), 0);
    }

    #[test]
    fn a_wedge_between_two_lines_is_left_as_far_as_a_bead_fits_into_it() {
        // From nothing to 0.5 mm wide.
        let lines = [bead(&[[0.0, 0.2], [10.0, 0.2]]), bead(&[[0.0, 0.6], [10.0, 1.1]])];
        let places = places(&region(&[[0.0, 0.0], [10.0, 0.0], [10.0, 1.3], [0.0, 0.8]]), &lines);
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
