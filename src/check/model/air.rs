//! What beads rest on.

use geometry::real;

use super::super::relief::Relief;
use crate::gcode::Stroke;

/// Beads are looked at every so often.
const STEP_MM: f64 = 0.2;
/// An end that hangs over less than this holds by itself.
const DANGLE_MM: f64 = 3.0;
/// What is so short is a corner or a dot.
const SHORTEST_MM: f64 = 1.5;
/// A layer may be this much thicker than it should be.
const SLACK_MM: f64 = 0.05;
/// Support leaves a gap of at most this under what it holds.
const GAP_MM: f64 = 0.4;
/// Ends nearer than this close a loop.
const CLOSED_MM: f64 = 0.3;

/// What is printed below: the model (with everything indistinguishable from it) and support.
pub(super) struct Ground {
    pub part: Relief,
    pub support: Relief,
    pub bed_mm: f64,
}

impl Ground {
    /// Whether something holds a bead of this size at a position: right under it, or beside that by a little more than
    /// half its width.
    fn holds(&self, [x, y, z]: [f64; 3], height_mm: f64, width_mm: f64) -> bool {
        let under_mm = z - height_mm;
        if under_mm - SLACK_MM <= self.bed_mm {
            return true;
        }
        let reach_mm = 0.6 * width_mm;
        let holds = |dx: f64, dy: f64| {
            let (x, y) = (x + dx * reach_mm, y + dy * reach_mm);
            self.part.at(x, y) >= under_mm - SLACK_MM || self.support.at(x, y) >= under_mm - GAP_MM
        };
        const SLANT: f64 = std::f64::consts::FRAC_1_SQRT_2;
        let around = [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)];
        let across = [(SLANT, SLANT), (SLANT, -SLANT), (-SLANT, SLANT), (-SLANT, -SLANT)];
        holds(0.0, 0.0) || around.into_iter().chain(across).any(|(dx, dy)| holds(dx, dy))
    }
}

/// The current path: beads without a travel between them.
#[derive(Default)]
pub(super) struct OpenPath {
    start: Option<[f64; 3]>,
    end: [f64; 3],
    length_mm: f64,
    /// From its start to the first position that is held; none if there is none yet.
    head_mm: Option<f64>,
    /// Since the last position that is held.
    tail_mm: f64,
}

impl OpenPath {
    /// Adds the next bead.
    pub fn add(&mut self, bead: &Stroke, height_mm: f64, width_mm: f64, ground: &Ground) {
        self.start.get_or_insert(bead.from);
        self.end = bead.to;
        let count = (bead.xy_mm / STEP_MM).ceil().clamp(1.0, 1e5) as u32;
        let step_mm = bead.xy_mm / f64::from(count);
        for i in 1..=count {
            self.length_mm += step_mm;
            self.tail_mm += step_mm;
            if ground.holds(bead.at((f64::from(i) - 0.5) / f64::from(count)), height_mm, width_mm) {
                self.head_mm.get_or_insert(self.length_mm - step_mm);
                self.tail_mm = 0.0;
            }
        }
    }

    /// Its last position.
    pub fn end(&self) -> [f64; 3] {
        self.end
    }

    /// Length without support at the end of the path, mm; 0 of a bridge, which is held at both ends.
    pub fn hanging_mm(&self) -> f64 {
        let Some(start) = self.start else { return 0.0 };
        let closed = real::hypot(start[0] - self.end[0], start[1] - self.end[1]) < CLOSED_MM;
        match self.head_mm {
            None if self.length_mm > SHORTEST_MM => self.length_mm,
            None => 0.0,
            Some(_) if closed => 0.0,
            Some(head_mm) => [head_mm, self.tail_mm].into_iter().filter(|mm| *mm > DANGLE_MM).sum(),
        }
    }
}
