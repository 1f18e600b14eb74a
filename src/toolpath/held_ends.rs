//! Infill over sparse infill: a line that would end between two lines beneath goes on to the nearest one.

use std::cell::LazyCell;
use std::f64::consts::PI;

use geometry::real;
use geometry::{Direction, EdgeGrid, Point, Region};

use super::hollow::Hollow;
use super::path::{Path, Role, Width};

/// What hangs over less than this holds by itself.
const DANGLE_MM: f64 = 2.2;

/// Sparse lines that hang over more than this are cut off.
const CUT_MM: f64 = 3.0;

/// Lines no longer than this that nothing holds are left out.
const LOOSE_MM: f64 = 3.5;

/// Lines go on, or are cut off, by at most this much,
const LONGEST_MM: f64 = 5.0;

/// at first over the lines beside their end: so many widths.
const PASSED: f64 = 1.7;

/// Distance of the points looked at on the way on,
const STEP_MM: f64 = 0.15;

/// and on a line.
const BACK_MM: f64 = 0.3;

/// So much of its width beside a line beneath, a line still lies on it.
const BESIDE: f64 = 0.6;

/// So far beside, a solid line goes on all the same. A sparse one would cover solid infill there.
const SOLID_BESIDE: f64 = 0.35;

/// Directions in which an end goes on: this many on each side, so far from each other.
const TURNS: i32 = 4;
const TURN_RAD: f64 = PI / 8.0;

/// A quarter turn is worth this share of the length.
const STRAIGHT: f64 = 0.3;

/// Extends the lines of infill whose ends hang over sparse infill beneath, through the layer's own `sparse` zone or into the
/// walls around `inside`. Sparse ones for which there is no way end where they are held. Leaves out short solid ones that
/// nothing holds.
pub(super) fn extend(
    paths: &mut Vec<Path>,
    first: usize,
    hollow: &Hollow<'_>,
    inside: &Region,
    sparse: &Region,
) {
    if hollow.sparse.is_empty() {
        return;
    }
    let area = LazyCell::new(|| EdgeGrid::new(inside));
    let free = LazyCell::new(|| EdgeGrid::new(sparse));
    let room = Room { hollow, is_inside: |p| area.contains(p), is_free: |p| free.contains(p) };
    let mut own = paths.split_off(first);
    own.retain_mut(|path| {
        let is_infill = matches!(path.role, Role::SolidInfill | Role::InternalInfill);
        !is_infill || room.extend(path)
    });
    paths.append(&mut own);
}

/// A point of a line.
struct LookedAt {
    point: Point,
    /// The vertex before it.
    before: usize,
    /// How far it is from the end.
    back_mm: f64,
    is_held: bool,
}

/// Where lines may go on.
struct Room<'a, I, F> {
    hollow: &'a Hollow<'a>,
    is_inside: I,
    is_free: F,
}

impl<I: Fn(Point) -> bool, F: Fn(Point) -> bool> Room<'_, I, F> {
    /// Extends a line where it hangs; `false`: it is to be left out.
    fn extend(&self, path: &mut Path) -> bool {
        let is_solid = path.role == Role::SolidInfill;
        let is_short = || geometry::polyline_length_mm(&path.points) < LOOSE_MM;
        if is_solid && is_short() && self.hangs(path, LOOSE_MM, BESIDE) {
            return false;
        }
        if path.closed {
            return true;
        }
        let width_mm = path.width.widest_mm();
        let beside = if is_solid { SOLID_BESIDE } else { BESIDE };
        for _ in 0..2 {
            path.points.reverse();
            if let Width::PerVertex(widths) = &mut path.width {
                widths.reverse();
            }
            if !self.hangs(path, DANGLE_MM, beside) {
                continue;
            }
            if let Some(tip) = self.tip(path, width_mm) {
                path.points.push(tip);
                if let Width::PerVertex(widths) = &mut path.width {
                    widths.push(width_mm as f32);
                }
            } else if !is_solid && self.hangs(path, CUT_MM, BESIDE) {
                self.cut(path);
            }
        }
        path.points.len() > 1
    }

    /// Where the end of a line that hangs there would be held.
    fn tip(&self, path: &Path, width_mm: f64) -> Option<Point> {
        let [.., before, end] = path.points[..] else { return None };
        let [x, y] = (end - before).mm();
        let onward_rad = real::atan2(y, x);
        let ways = (-TURNS..=TURNS).filter_map(|turn| {
            let direction = Direction::of(onward_rad + f64::from(turn) * TURN_RAD);
            let along_mm = self.held_mm(end, direction, width_mm)?;
            let cost_mm = along_mm * (1.0 + STRAIGHT * f64::from(turn.abs()) * TURN_RAD / (PI / 2.0));
            Some((cost_mm, direction.from(end, along_mm, 0.0)))
        });
        ways.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, tip)| tip)
    }

    /// Ends a sparse line that hangs where it is held last, if that is near: what is far may be held by what is not known here.
    fn cut(&self, path: &mut Path) {
        let near = |at: &LookedAt| at.back_mm <= LONGEST_MM;
        let held = self.looked_at(path, BESIDE).take_while(near).find(|at| at.is_held);
        let Some(LookedAt { before, point: end, .. }) = held else { return };
        path.points.truncate(before + 1);
        if let Width::PerVertex(widths) = &mut path.width {
            widths.truncate(before + 2);
        }
        if path.points[before] != end {
            path.points.push(end);
        } else if let Width::PerVertex(widths) = &mut path.width {
            widths.pop();
        }
    }

    /// Whether nothing holds a line over so much of its end.
    fn hangs(&self, path: &Path, over_mm: f64, beside: f64) -> bool {
        let mut looked_at = self.looked_at(path, beside);
        let first = looked_at.find(|at| at.is_held || at.back_mm > over_mm);
        first.is_none_or(|at| at.back_mm > over_mm)
    }

    /// Points of a line, from its end, and whether something is under them or so many widths beside.
    fn looked_at(&self, path: &Path, beside: f64) -> impl Iterator<Item = LookedAt> {
        let mut walked_mm = 0.0;
        path.points.windows(2).enumerate().rev().flat_map(move |(before, pair)| {
            let length_mm = pair[0].distance_mm(pair[1]);
            let count = (length_mm / BACK_MM).ceil().max(1.0);
            let ([ax, ay], [bx, by]) = (pair[0].mm(), pair[1].mm());
            let reach_mm = beside * path.width.at_mm(before).min(path.width.at_mm(before + 1));
            let from_mm = walked_mm;
            walked_mm += length_mm;
            (0..count as u32).map(move |step| {
                let share = f64::from(step) / count;
                let point = Point::from_mm(bx + share * (ax - bx), by + share * (ay - by));
                let back_mm = from_mm + share * length_mm;
                LookedAt { point, before, back_mm, is_held: self.hollow.holds(point, reach_mm) }
            })
        })
    }

    /// How far it is to something that holds, through what is free.
    fn held_mm(&self, end: Point, direction: Direction, width_mm: f64) -> Option<f64> {
        let steps = (LONGEST_MM / STEP_MM) as u32;
        let mut outside = 0;
        // The outermost wall shows.
        let in_walls_mm = width_mm.min(self.hollow.walls_mm - width_mm);
        for step in 1..=steps {
            let along_mm = f64::from(step) * STEP_MM;
            let p = direction.from(end, along_mm, 0.0);
            if !(self.is_inside)(p) {
                outside += 1;
                if f64::from(outside) * STEP_MM > in_walls_mm {
                    return None;
                }
            } else if along_mm > PASSED * width_mm && !(self.is_free)(p) {
                return None;
            }
            if self.hollow.holds(p, STEP_MM / 2.0) {
                return Some(along_mm);
            }
        }
        None
    }
}
