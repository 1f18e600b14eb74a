//! Walls of the parts of an object where they meet other parts.
//!
//! A bead turns a corner in its own round, and leaves the corner itself open: around a whole object there are few, but each border
//! between two parts has some at either end, of every wall. There walls are pressed outwards a little. Single beads, which fill what
//! is too narrow for a loop, are no wider than the room between the other parts.

use super::bead;
use super::path::{Path, Role, Width};
use geometry::{EdgeGrid, Point, Region};

/// Flatter turns leave next to nothing open: cosine of 30°.
const FLAT: f64 = 0.866;

/// At a corner a wall is pressed so far into another of its part, or towards the outline, mm.
const PRESSED_MM: f64 = 0.04;

/// The same towards another part, whose wall does the same.
const TOWARDS_OTHERS_MM: f64 = 0.012;

/// A corner's bead is moved no further, mm: tips of sharp ones would be.
const FURTHEST_MM: f64 = 0.08;

/// The sides of a corner are at least so long, in widths.
const SIDE: f64 = 0.5;

/// Sides of which the ends are this share of their length apart are straight.
const STRAIGHT: f64 = 0.97;

/// So far from the corner, in widths, a wall is where it was: less than half of a side, of which the other end may be pressed, too.
const REACH: f64 = 0.14;

/// A single bead may lie so far over another part, mm.
const OVER_MM: f64 = 0.015;

/// Where there is not so much room between others, mm, a single bead ends.
const LEAST_MM: f64 = 0.15;

/// Single beads that are shorter are none, mm.
const SHORTEST_MM: f64 = 0.1;

/// Where another part reaches into a single bead is found by halving so often.
const HALVINGS: u32 = 6;

/// What a part of an object meets.
pub(super) struct Borders {
    others: EdgeGrid,
    /// Others reach so far over their border, mm: round sides of walls press into each other.
    pressed_mm: f64,
}

impl Borders {
    /// Of a part beside others, on a layer so high.
    pub fn new(others: &Region, height_mm: f64) -> Self {
        Self { others: EdgeGrid::new(others), pressed_mm: bead::rounding_mm(height_mm) / 2.0 }
    }

    /// Makes walls keep to their part, and fill its corners.
    pub fn fit(&self, paths: &mut Vec<Path>) {
        for path in paths.iter_mut() {
            if path.closed {
                self.thin(path);
                self.press(path);
            } else {
                self.narrow(path);
            }
        }
        paths.retain(|path| path.closed || path.points.len() > 1);
    }

    /// Makes a loop narrower where another part is so near.
    fn thin(&self, path: &mut Path) {
        let rounding_mm = 2.0 * self.pressed_mm;
        let fitting = |(k, point): (usize, &Point)| {
            let width_mm = path.width.at_mm(k);
            let room_mm = self.room_mm(*point, width_mm - rounding_mm).max(LEAST_MM);
            width_mm.min(room_mm + rounding_mm) as f32
        };
        let widths: Vec<f32> = path.points.iter().enumerate().map(fitting).collect();
        if (0..widths.len()).any(|k| widths[k] < path.width.at_mm(k) as f32) {
            path.width = Width::PerVertex(widths);
        }
    }

    /// Presses the corners of a loop outwards.
    fn press(&self, path: &mut Path) {
        let count = path.points.len();
        let corners: Vec<[f64; 2]> = path.points.iter().map(|point| point.mm()).collect();
        let mut ways: Vec<Option<Way>> = vec![None; count];
        let mut is_left_out = vec![false; count];
        for k in 0..count {
            let width_mm = path.width.at_mm(k);
            let sides = |share: f64| {
                let [before, after] = [false, true].map(|ahead| side(&corners, k, ahead, share * width_mm));
                Some([before?, after?])
            };
            let (Some([before, after]), Some(moved)) = (sides(SIDE), sides(REACH)) else { continue };
            let corner = [before.end, corners[k], after.end];
            let Some(tip) = self.pressed(corner, width_mm, path.role != Role::Perimeter) else { continue };
            ways[k] = Some([moved[0].end, tip, moved[1].end]);
            moved.into_iter().flat_map(|side| side.between).for_each(|near| is_left_out[near] = true);
        }
        let (mut points, mut from) = (Vec::with_capacity(count), Vec::with_capacity(count));
        for (k, way) in ways.into_iter().enumerate().filter(|(k, way)| way.is_some() || !is_left_out[*k]) {
            match way {
                Some(way) => points.extend(way.map(|[x, y]| Point::from_mm(x, y))),
                None => points.push(path.points[k]),
            }
            from.resize(points.len(), k);
        }
        if let Width::PerVertex(widths) = &mut path.width {
            *widths = from.iter().map(|&k| widths[k]).collect();
        }
        path.points = points;
    }

    /// Where a bead turns, if it has to turn elsewhere than at the corner `at`.
    fn pressed(&self, [before, at, after]: [[f64; 2]; 3], width_mm: f64, is_outer: bool) -> Option<[f64; 2]> {
        let (into, out) = (unit(before, at)?, unit(at, after)?);
        let cosine = into[0] * out[0] + into[1] * out[1];
        let sine = into[0] * out[1] - into[1] * out[0];
        if cosine > FLAT || sine == 0.0 {
            return None;
        }
        // What is printed lies left of walls: they turn left where the outside is.
        let normals = [into, out].map(|[x, y]| if sine > 0.0 { [y, -x] } else { [-y, x] });
        let by_mm = if is_outer && sine > 0.0 {
            let is_border = |side: usize| {
                let on = towards(at, [before, after][side], 0.5);
                let [x, y] = [0, 1].map(|i| on[i] + width_mm * normals[side][i]);
                self.others.contains(Point::from_mm(x, y))
            };
            match [is_border(0), is_border(1)] {
                [true, false] => [TOWARDS_OTHERS_MM, PRESSED_MM],
                [false, true] => [PRESSED_MM, TOWARDS_OTHERS_MM],
                // A corner of the whole object, or one that other parts are all around.
                _ => return None,
            }
        } else {
            [PRESSED_MM; 2]
        };
        let half_cosine = ((1.0 + cosine) / 2.0).sqrt();
        let open_mm = width_mm / 2.0 * (1.0 / half_cosine - 1.0);
        // Both sides moved outwards meet there.
        let [a, b] = normals;
        let determinant = a[0] * b[1] - a[1] * b[0];
        let shift = [
            (by_mm[0] * b[1] - by_mm[1] * a[1]) / determinant,
            (by_mm[1] * a[0] - by_mm[0] * b[0]) / determinant,
        ];
        let length_mm = geometry::distance_mm([0.0; 2], shift);
        let share = (FURTHEST_MM.min(open_mm) / length_mm).min(1.0);
        Some([0, 1].map(|i| at[i] + share * shift[i]))
    }

    /// Makes a single bead as narrow as the room between other parts, and ends it where that is none.
    fn narrow(&self, path: &mut Path) {
        let Width::PerVertex(widths) = &mut path.width else { return };
        let rounding_mm = 2.0 * self.pressed_mm;
        let most: Vec<f64> = path
            .points
            .iter()
            .zip(widths.iter())
            .map(|(point, width)| {
                let spacing_mm = f64::from(*width) - rounding_mm;
                self.room_mm(*point, spacing_mm).min(spacing_mm)
            })
            .collect();
        let fits = |room_mm: &f64| *room_mm >= LEAST_MM;
        let (Some(first), Some(last)) = (most.iter().position(fits), most.iter().rposition(fits)) else {
            // Beads that are as narrow by themselves stay.
            let is_short_of =
                |(room_mm, width): (&f64, &f32)| (*room_mm as f32) < *width - rounding_mm as f32;
            if most.iter().zip(widths.iter()).any(is_short_of) {
                path.points.clear();
            }
            return;
        };
        let ends = [(first, first.checked_sub(1)), (last, Some(last + 1).filter(|next| *next < most.len()))];
        let ends = ends.map(|(on, off)| off.map(|off| self.end(path.points[on], path.points[off])));
        for (width, room_mm) in widths.iter_mut().zip(&most) {
            *width = width.min((room_mm.max(LEAST_MM) + rounding_mm) as f32);
        }
        path.points.truncate(last + 1);
        widths.truncate(last + 1);
        path.points.drain(..first);
        widths.drain(..first);
        let [before, after] = ends;
        let narrowest = (LEAST_MM + rounding_mm) as f32;
        if let Some(end) = after.filter(|end| path.points.last() != Some(end)) {
            path.points.push(end);
            widths.push(narrowest);
        }
        if let Some(end) = before.filter(|end| path.points.first() != Some(end)) {
            path.points.insert(0, end);
            widths.insert(0, narrowest);
        }
        if geometry::polyline_length_mm(&path.points) < SHORTEST_MM {
            path.points.clear();
        }
    }

    /// The widest spacing of a bead about a point, as far as it is less than this.
    fn room_mm(&self, at: Point, spacing_mm: f64) -> f64 {
        let to_edge_mm = self.others.distance_mm(at, spacing_mm);
        let free_mm = if self.others.contains(at) { -to_edge_mm } else { to_edge_mm };
        2.0 * (free_mm + self.pressed_mm + OVER_MM)
    }

    /// Where the narrowest bead ends between a point where it has room and one where it has not.
    fn end(&self, mut on: Point, mut off: Point) -> Point {
        for _ in 0..HALVINGS {
            let middle = on.towards(off, 0.5);
            if self.room_mm(middle, LEAST_MM) >= LEAST_MM { on = middle } else { off = middle }
        }
        on
    }
}

/// Where a wall goes before a corner's tip, the tip, and where it goes behind it.
type Way = [[f64; 2]; 3];

/// A side of a corner.
struct Side {
    /// A point on it.
    end: [f64; 2],
    /// The vertices between that and the corner.
    between: Vec<usize>,
}

/// The side of a loop's corner that is so long, if it is straight.
fn side(corners: &[[f64; 2]], corner: usize, ahead: bool, length_mm: f64) -> Option<Side> {
    let count = corners.len();
    let next = |k: usize| if ahead { (k + 1) % count } else { (k + count - 1) % count };
    let (mut at, mut left_mm, mut between) = (corner, length_mm, Vec::new());
    loop {
        let to = next(at);
        let step_mm = geometry::distance_mm(corners[at], corners[to]);
        if step_mm >= left_mm {
            let end = towards(corners[at], corners[to], left_mm / step_mm);
            let is_straight = geometry::distance_mm(corners[corner], end) >= STRAIGHT * length_mm;
            return is_straight.then_some(Side { end, between });
        }
        if to == corner {
            return None;
        }
        left_mm -= step_mm;
        between.push(to);
        at = to;
    }
}

fn towards(from: [f64; 2], to: [f64; 2], share: f64) -> [f64; 2] {
    [0, 1].map(|i| from[i] + share * (to[i] - from[i]))
}

/// The direction from one point to another.
fn unit(from: [f64; 2], to: [f64; 2]) -> Option<[f64; 2]> {
    let length_mm = geometry::distance_mm(from, to);
    (length_mm > 0.0).then(|| [0, 1].map(|i| (to[i] - from[i]) / length_mm))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::toolpath::Phase;
    use geometry::{Polygon, Ring};

    fn ring(corners: &[[f64; 2]]) -> Ring {
        corners.iter().map(|[x, y]| Point::from_mm(*x, *y)).collect()
    }

    fn region(corners: &[[f64; 2]]) -> Region {
        Region::from(Polygon { outer: ring(corners), holes: Vec::new() })
    }

    fn path(points: Ring, closed: bool, width: Width) -> Path {
        Path {
            role: Role::ExternalPerimeter,
            closed,
            points,
            width,
            height_mm: 0.2,
            island: None,
            phase: Phase::Wall(0),
            tool: None,
        }
    }

    #[test]
    fn an_outermost_wall_is_pressed_where_a_border_ends_and_nowhere_else() {
        let right = region(&[[10.0, 0.0], [20.0, 0.0], [20.0, 10.0], [10.0, 10.0]]);
        let wall = ring(&[[0.2, 0.2], [9.8, 0.2], [9.8, 9.8], [0.2, 9.8]]);
        let mut paths = vec![path(wall.clone(), true, Width::Constant(0.443))];
        Borders::new(&right, 0.2).fit(&mut paths);
        let points = &paths[0].points;
        assert_eq!([points[0], points[7]], [wall[0], wall[3]], "corners of the whole object");
        let [right_mm, up_mm] = points[5].mm();
        assert!((right_mm - 9.8 - TOWARDS_OTHERS_MM).abs() < 1e-4, "{right_mm}");
        assert!((up_mm - 9.8 - PRESSED_MM).abs() < 1e-4, "{up_mm}");
        // It is where it was before and behind its corners.
        for [a, b] in [[4, 3], [6, 7]] {
            let along = [points[a].mm(), points[b].mm()];
            assert!((0..2).any(|i| (along[0][i] - along[1][i]).abs() < 1e-4), "{along:?}");
        }
    }

    #[test]
    fn a_single_bead_ends_where_other_parts_leave_no_room_for_it() {
        // A wedge of 20° between two others.
        let slope = geometry::real::tan(10f64.to_radians());
        let sides =
            [1.0, -1.0].map(|side| region(&[[0.0, 0.0], [0.0, side * 9.0], [9.0, side * 9.0 * slope]]));
        let others = geometry::union_all(&sides);
        let widths = [0.243, 0.243, 0.4];
        let along = ring(&[[0.1, 0.0], [0.5, 0.0], [1.2, 0.0]]);
        let mut paths = vec![path(along, false, Width::PerVertex(widths.to_vec()))];
        Borders::new(&others, 0.2).fit(&mut paths);
        let Width::PerVertex(widths) = &paths[0].width else { panic!("its widths differ") };
        let beads = paths[0].points.iter().zip(widths);
        for (point, width_mm) in beads {
            let half_mm = (f64::from(*width_mm) - bead::rounding_mm(0.2)) / 2.0;
            let room_mm = point.mm()[0] * geometry::real::sin(10f64.to_radians());
            let most_mm = room_mm + OVER_MM + bead::rounding_mm(0.2) / 2.0 + 1e-3;
            assert!(half_mm <= most_mm, "{half_mm} mm at {point:?}, where it has {room_mm} mm");
        }
        assert!(paths[0].points[0].mm()[0] > 0.2, "{:?}", paths[0].points);
    }
}
