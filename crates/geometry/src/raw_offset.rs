//! Offset curves of single rings, before overlaps are taken out.

use crate::real;

use super::point::nearest_unit;
use super::{Point, Ring, UNITS_PER_MM};

/// How the gap at a corner is closed on the side where the offset edges part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Join {
    /// Edges are extended until they meet. Where that point would be farther than `limit` times the distance
    /// from the corner (for 2: corners sharper than 60°) the corner is cut off square, at the distance.
    Miter {
        /// Farthest meeting point, in distances; at least 1.
        limit: f64,
    },
    /// An arc, as chords that stray from it by at most the tolerance.
    Round {
        /// Largest distance between arc and chord, in millimetres.
        tolerance_mm: f64,
    },
}

/// Farthest that results may lie from the origin, in units, for products of differences to fit an `i64`.
const LIMIT: f64 = 1.07e9;

impl Default for Join {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Join {
    /// Corners sharper than 60° are cut off square.
    pub const DEFAULT: Self = Self::Miter { limit: 2.0 };

    /// The farthest that a join may lie from its corner, in distances.
    pub(super) fn reach(self) -> f64 {
        match self {
            // A square corner reaches √2 at most, an inner one is nearer than the limit or within its neighbours.
            Join::Miter { limit } => limit.max(std::f64::consts::SQRT_2),
            Join::Round { .. } => 1.5,
        }
    }
}

/// Below this value of 1 + cos(turn) a corner is a needle (sharper than 1.6°), whose inner offset point is too far away
/// to be of use.
const NEEDLE: f64 = 4e-4;

/// Above this value of 1 + cos(turn) a turn is slight (up to 14°): its mitre is within 0.8 % of the distance from the arc.
const SLIGHT: f64 = 1.97;

/// Tangent of half the turn at a corner of 67°: where it is sharper than 60°, the offset back is cut square.
const BLUNT: f64 = 1.5;

/// Offset edges longer than this stay when the result is simplified, where that makes a difference.
const SURE_MM: f64 = 0.02;

#[derive(Clone, Copy)]
struct Vector {
    x: f64,
    y: f64,
}

impl Vector {
    fn between(a: Point, b: Point) -> Self {
        Self { x: f64::from(b.x) - f64::from(a.x), y: f64::from(b.y) - f64::from(a.y) }
    }

    fn cross(self, o: Self) -> f64 {
        self.x * o.y - self.y * o.x
    }

    fn dot(self, o: Self) -> f64 {
        self.x * o.x + self.y * o.y
    }

    /// This moved by `k` times another.
    fn plus(self, k: f64, o: Self) -> Self {
        Self { x: self.x + k * o.x, y: self.y + k * o.y }
    }

    /// Turned clockwise by a right angle.
    fn right(self) -> Self {
        Self { x: self.y, y: -self.x }
    }

    fn point(self) -> Point {
        let grid = |v: f64| nearest_unit(v.clamp(-LIMIT, LIMIT));
        Point::new(grid(self.x), grid(self.y))
    }
}

/// A corner with its outgoing edge.
#[derive(Clone, Copy)]
struct Corner {
    at: Vector,
    /// Unit vector of the outgoing edge.
    along: Vector,
    /// Length of the outgoing edge.
    length: f64,
    /// How much the turn here lengthens the offset of the edges on both sides.
    gain: f64,
    before: u32,
    after: u32,
}

/// Offsets rings to their right by `by` units (to their left where negative).
#[derive(Default)]
pub(super) struct RingOffset {
    by: f64,
    join: Join,
    /// Smallest 1 + cos(turn) at which a mitre is within its limit.
    miter_floor: f64,
    /// Largest turn of one chord of a round join.
    arc_step: f64,
    corners: Vec<Corner>,
    /// Edges whose offset has a negative length.
    lost: Vec<u32>,
    /// Whether the last [`Self::front`], moved back, covers the ring's side of all edges again: only edges of convex curves went,
    /// and no corner is much sharper than a right angle on the side that the edges move to.
    pub(super) is_whole: bool,
}

impl RingOffset {
    /// From now on offsets by other units.
    pub(super) fn set(&mut self, by: f64, join: Join) {
        let (miter_floor, arc_step) = match join {
            Join::Miter { limit } => (2.0 / (limit * limit).max(1.0), 0.0),
            Join::Round { tolerance_mm } => {
                let sagitta = (tolerance_mm * UNITS_PER_MM / by.abs()).clamp(1e-6, 0.5);
                let step = 2.0 * real::acos(1.0 - sagitta);
                // Up to this turn a mitre strays no farther from the arc than its chord would.
                (1.0 + real::cos(step), step)
            }
        };
        (self.by, self.join) = (by, join);
        (self.miter_floor, self.arc_step) = (miter_floor, arc_step);
    }

    /// The offset curve whose edges are the ring's, moved, extended or shortened to meet, without those that
    /// have shrunk to nothing: the wavefront of a straight skeleton (Aichholzer et al. 1995,
    /// doi:10.1007/978-3-642-80350-5_65) as long as it does not split. `None` where it vanishes or shows that it did
    /// split. Else it is the offset, provided that it touches neither itself nor another. No two neighbouring points
    /// of the ring may be equal. The curve replaces the contents of `curve`.
    pub(super) fn front(&mut self, ring: &[Point], curve: &mut Ring) -> Option<()> {
        self.load(ring);
        self.drop_lost_edges()?;
        curve.clear();
        // Walking by links passes only the corners that are left.
        let first = self.corners.iter().enumerate().position(|(i, c)| self.is_linked(i, c))?;
        let mut i = first;
        loop {
            let corner = self.corners[i];
            let before = self.corners[corner.before as usize].along;
            self.push_join(curve, corner.at, before, corner.along);
            i = corner.after as usize;
            if i == first {
                break;
            }
        }
        Some(())
    }

    /// The offset curve of every edge at its full length, joined through the corner itself where offset edges cross:
    /// its points of positive winding are the offset (Chen & McMains 2005, doi:10.1115/DETC2005-85513). The curve replaces the
    /// contents of `curve`.
    pub(super) fn raw(&mut self, ring: &[Point], curve: &mut Ring) {
        self.load(ring);
        curve.clear();
        for corner in &self.corners {
            let before = &self.corners[corner.before as usize];
            let (at, u, v) = (corner.at, before.along, corner.along);
            // A mitre that takes less than half of either edge cuts off points near this corner only.
            let local = corner.gain.abs() <= 0.5 * before.length.min(corner.length);
            if local || self.parts(u, v) {
                self.push_join(curve, at, u, v);
            } else {
                let ends = [at.plus(self.by, u.right()), at, at.plus(self.by, v.right())];
                curve.extend(ends.map(Vector::point));
            }
        }
    }

    fn load(&mut self, ring: &[Point]) {
        let n = ring.len();
        self.corners.clear();
        self.corners.extend(ring.iter().enumerate().map(|(i, &a)| {
            let (before, after) = (if i == 0 { n } else { i } - 1, if i + 1 == n { 0 } else { i + 1 });
            let edge = Vector::between(a, ring[after]);
            let length = edge.dot(edge).sqrt();
            let along = Vector { x: edge.x / length, y: edge.y / length };
            let at = Vector::between(Point::new(0, 0), a);
            Corner { at, along, length, gain: 0.0, before: before as u32, after: after as u32 }
        }));
        let Some(mut before) = self.corners.last().map(|c| c.along) else {
            return;
        };
        for i in 0..n {
            let along = self.corners[i].along;
            self.corners[i].gain = self.gain(before, along);
            before = along;
        }
    }

    /// Whether the offset edges part at the turn from direction `u` to `v`, so that a join fills the gap.
    fn parts(&self, u: Vector, v: Vector) -> bool {
        u.cross(v) * self.by > 0.0
    }

    /// How much the turn from `u` to `v` lengthens the offset of either edge (negative: shortens).
    fn gain(&self, u: Vector, v: Vector) -> f64 {
        let open = 1.0 + u.dot(v);
        if self.parts(u, v) && open < self.miter_floor {
            match self.join {
                Join::Miter { .. } => self.by.abs() * square_gain(open),
                Join::Round { .. } => 0.0,
            }
        } else if open < NEEDLE {
            f64::NEG_INFINITY
        } else {
            self.by * u.cross(v) / open
        }
    }

    fn is_lost(&self, i: usize) -> bool {
        let corner = &self.corners[i];
        corner.length + corner.gain + self.corners[corner.after as usize].gain < 0.0
    }

    fn is_linked(&self, i: usize, corner: &Corner) -> bool {
        self.corners[corner.before as usize].after as usize == i
    }

    /// Takes out the edges whose offset has a negative length; their neighbours meet instead.
    fn drop_lost_edges(&mut self) -> Option<()> {
        self.lost.clear();
        for i in 0..self.corners.len() {
            if self.is_lost(i) {
                self.lost.push(i as u32);
            }
        }
        let mut left = self.corners.len();
        let mut is_convex = true;
        while let Some(i) = self.lost.pop() {
            let edge = self.corners[i as usize];
            if !self.is_linked(i as usize, &edge) || !self.is_lost(i as usize) {
                continue;
            }
            if left <= 3 {
                return None;
            }
            let (a, c) = (self.corners[edge.before as usize], self.corners[edge.after as usize]);
            // Beyond a join the neighbour must not be extended as if its edge continued there.
            let joined = |u: Vector, v: Vector| self.parts(u, v) && 1.0 + u.dot(v) < SLIGHT;
            if joined(a.along, edge.along) || joined(edge.along, c.along) {
                return None;
            }
            is_convex &= !self.parts(a.along, edge.along) && !self.parts(edge.along, c.along);
            let turn = a.along.cross(c.along);
            if turn * self.by > 0.0 || turn.abs() < NEEDLE || 1.0 + a.along.dot(c.along) < NEEDLE {
                return None;
            }
            let reach = c.at.plus(-1.0, a.at).cross(c.along) / turn;
            let meeting = a.at.plus(reach, a.along);
            let gain = self.gain(a.along, c.along);
            let before = &mut self.corners[edge.before as usize];
            before.length = reach;
            before.after = edge.after;
            let after = &mut self.corners[edge.after as usize];
            after.length += c.at.plus(-1.0, meeting).dot(c.along);
            after.at = meeting;
            after.gain = gain;
            after.before = edge.before;
            // Unlinks the edge for good, also where it is its own neighbour's neighbour.
            self.corners[i as usize].before = i;
            self.corners[i as usize].after = u32::MAX;
            left -= 1;
            for neighbour in [edge.before, edge.after] {
                if self.is_lost(neighbour as usize) {
                    self.lost.push(neighbour);
                }
            }
        }
        let is_sure = |corner: &Corner| {
            let end = self.corners[corner.after as usize].gain;
            let stays = corner.length + corner.gain + end > SURE_MM * UNITS_PER_MM;
            corner.gain > -BLUNT * self.by.abs() && (stays || (corner.gain <= 0.0 && end <= 0.0))
        };
        let mut corners = self.corners.iter().enumerate();
        self.is_whole = is_convex && corners.all(|(i, corner)| !self.is_linked(i, corner) || is_sure(corner));
        Some(())
    }

    fn push_join(&self, curve: &mut Ring, at: Vector, u: Vector, v: Vector) {
        let open = 1.0 + u.dot(v);
        if !self.parts(u, v) || open >= self.miter_floor {
            let k = self.by / open;
            curve.push(at.plus(k, u.right()).plus(k, v.right()).point());
            return;
        }
        match self.join {
            Join::Miter { .. } => {
                let k = self.by.abs() * square_gain(open);
                curve.push(at.plus(self.by, u.right()).plus(k, u).point());
                curve.push(at.plus(self.by, v.right()).plus(-k, v).point());
            }
            Join::Round { .. } => {
                let turn = real::atan2(u.cross(v), u.dot(v));
                let chords = (turn.abs() / self.arc_step).ceil().max(1.0);
                for i in 0..=chords as usize {
                    let (sin, cos) = real::sin_cos(turn * i as f64 / chords);
                    let direction = Vector { x: u.x * cos - u.y * sin, y: u.x * sin + u.y * cos };
                    curve.push(at.plus(self.by, direction.right()).point());
                }
            }
        }
    }
}

/// How far a square corner, at distance 1 from the vertex, lengthens its edges: the tangent of a quarter of the turn,
/// from 1 + cos(turn).
fn square_gain(open: f64) -> f64 {
    let half = (open.max(0.0) / 2.0).sqrt();
    ((1.0 - half) / (1.0 + half)).sqrt()
}
