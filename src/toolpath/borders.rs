//! Walls of the parts of an object where they meet other parts.
//!
//! A bead turns a corner in its own round, and leaves the corner itself open: around a whole object there are few, but each border
//! between two parts has some at either end, of every wall. There walls are pressed outwards a little. Single beads, which fill what
//! is too narrow for a loop, are no wider than the room between the other parts.

use super::path::{Path, Role, Width};
use super::{ObjectLayer, bead};
use geometry::{EdgeGrid, Point, Region};

/// Flatter turns leave next to nothing open: cosine of 30°.
const FLAT: f64 = 0.866;

/// At a corner a wall is pressed so far into another of its part, or towards the outline, mm.
const PRESSED_MM: f64 = 0.03;

/// The same towards another part, whose wall does the same.
const TOWARDS_OTHERS_MM: f64 = 0.012;

/// A corner's bead is moved no further, mm: tips of sharp ones would be.
const FURTHEST_MM: f64 = 0.06;

/// So far from the corner, in widths, a wall is where it was.
const REACH: f64 = 0.3;

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
    /// Those of a part of an object on a layer so high; `None`: it is the whole.
    pub fn of(part: &ObjectLayer<'_>, all: &[ObjectLayer<'_>], height_mm: f64) -> Option<Self> {
        let is_other = |other: &&ObjectLayer<'_>| {
            other.object == part.object && other.tool != part.tool && other.share.is_none_or(|s| s.has_walls)
        };
        part.tool?;
        let others: Vec<&Region> = all.iter().filter(is_other).map(|other| other.section).collect();
        if others.is_empty() {
            return None;
        }
        let others = EdgeGrid::new(&geometry::union_all(others));
        Some(Self { others, pressed_mm: bead::rounding_mm(height_mm) / 2.0 })
    }

    /// Makes walls keep to their part, and fill its corners.
    pub fn fit(&self, paths: &mut Vec<Path>) {
        for path in paths.iter_mut() {
            if path.closed {
                self.press(path);
            } else {
                self.narrow(path);
            }
        }
        paths.retain(|path| path.closed || path.points.len() > 1);
    }

    /// Presses the corners of a loop outwards.
    fn press(&self, path: &mut Path) {
        let count = path.points.len();
        let corners: Vec<[f64; 2]> = path.points.iter().map(|point| point.mm()).collect();
        let (mut points, mut from) = (Vec::with_capacity(count), Vec::with_capacity(count));
        for (k, at) in corners.iter().copied().enumerate() {
            let [before, after] = [(k + count - 1) % count, (k + 1) % count].map(|other| corners[other]);
            let width_mm = width_mm(&path.width, k);
            match self.pressed([before, at, after], width_mm, path.role != Role::Perimeter) {
                None => points.push(path.points[k]),
                Some(tip) => {
                    let beside = |other: [f64; 2]| {
                        let share = REACH * width_mm / geometry::distance_mm(at, other);
                        // The corner at the other end may be moved, too.
                        (share < 0.4).then(|| towards(at, other, share))
                    };
                    let around = [beside(before), Some(tip), beside(after)];
                    points.extend(around.into_iter().flatten().map(|[x, y]| Point::from_mm(x, y)));
                }
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
            let middles = [towards(at, before, 0.5), towards(at, after, 0.5)];
            let beside = |side: usize| {
                let along_mm = geometry::distance_mm(at, middles[side]).min(width_mm / 2.0);
                let on = [0, 1].map(|i| at[i] + along_mm * [-into[i], out[i]][side]);
                let [x, y] = [0, 1].map(|i| on[i] + width_mm * normals[side][i]);
                self.others.contains(Point::from_mm(x, y))
            };
            match [beside(0), beside(1)] {
                // A corner of the whole object.
                [false, false] => return None,
                sides => sides.map(|is_border| if is_border { TOWARDS_OTHERS_MM } else { PRESSED_MM }),
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
            if !most
                .iter()
                .zip(widths.iter())
                .all(|(room, width)| *room as f32 >= *width - rounding_mm as f32)
            {
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

fn width_mm(width: &Width, vertex: usize) -> f64 {
    match width {
        Width::Constant(width_mm) => *width_mm,
        Width::PerVertex(widths) => widths[vertex].into(),
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
