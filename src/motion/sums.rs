//! Lengths and volume of planned moves, as they would be measured on the finished file.

use super::{LayerMoves, Move};
use crate::toolpath::Role;
use crate::units::{Mm, Mm3};
use geometry::distance_mm;
use geometry::real;

/// Sums of a layer's moves. Distances are in X and Y; those before the first bead of the print do not count.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LayerSums {
    /// Distance while extruding.
    pub print: Mm,
    /// Distance without, the travel from the layer below included.
    pub travel: Mm,
    /// Straight lines from the end of each bead to the start of the next, joined beads counting as one.
    pub link: Mm,
    /// Travels from one bead to another.
    pub travels: usize,
    /// Filament retracted.
    pub retractions: usize,
    /// Filament extruded.
    pub volume: Mm3,
}

impl std::ops::AddAssign for LayerSums {
    fn add_assign(&mut self, other: Self) {
        self.print += other.print;
        self.travel += other.travel;
        self.link += other.link;
        self.travels += other.travels;
        self.retractions += other.retractions;
        self.volume += other.volume;
    }
}

impl LayerMoves {
    /// Sums up the layer. O(moves).
    pub fn sums(&self) -> LayerSums {
        let mut sums = LayerSums::default();
        let mut at = self.from.xy;
        let mut bead_end = self.from.xy;
        let mut travel_mm = 0.0;
        let mut retracted = false;
        for step in &self.moves {
            match step {
                Move::Travel { to, .. } | Move::Climb { to, .. } | Move::Wipe { to, .. } => {
                    travel_mm += at.map_or(0.0, |at| distance_mm(at, *to));
                    at = Some(*to);
                }
                Move::Extrude { to, volume, .. }
                | Move::Ramp { to, volume, .. }
                | Move::Arc { to, volume, .. } => {
                    let start = at.unwrap_or(*to);
                    if let (true, Some(end)) = (travel_mm > 0.0, bead_end) {
                        sums.travel += Mm(travel_mm);
                        sums.link += Mm(distance_mm(end, start));
                        sums.travels += 1;
                    }
                    travel_mm = 0.0;
                    sums.print += Mm(drawn_mm(step, start));
                    sums.volume += *volume;
                    (at, bead_end) = (Some(*to), Some(*to));
                }
                _ => {}
            }
            match step {
                Move::Retract { .. } | Move::Wipe { .. } => {
                    sums.retractions += usize::from(!retracted);
                    retracted = true;
                }
                Move::Unretract { .. } => retracted = false,
                _ => {}
            }
        }
        sums
    }
}

/// What a tool prints in a layer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToolSums {
    /// Filament extruded, flushing included, mm³.
    pub volume_mm3: f64,
    /// Of that, what went into the prime tower, mm³.
    pub flushed_mm3: f64,
    /// How often it was taken instead of another.
    pub taken: usize,
}

impl LayerMoves {
    /// The filament of each of so many tools.
    pub fn by_tool(&self, tools: usize) -> Vec<ToolSums> {
        let mut sums = vec![ToolSums::default(); tools];
        let (mut tool, mut flushes) = (usize::from(self.from.tool), false);
        for step in &self.moves {
            match step {
                Move::Bead { role, .. } => flushes = *role == Role::PrimeTower,
                Move::ToolChange(change) => {
                    tool = change.to.into();
                    if let Some(own) = sums.get_mut(tool) {
                        own.taken += 1;
                    }
                }
                Move::Extrude { volume, .. } | Move::Ramp { volume, .. } | Move::Arc { volume, .. } => {
                    if let Some(own) = sums.get_mut(tool) {
                        own.volume_mm3 += volume.0;
                        own.flushed_mm3 += if flushes { volume.0 } else { 0.0 };
                    }
                }
                _ => {}
            }
        }
        sums
    }
}

/// Length of what a move draws from where the nozzle is.
pub(super) fn drawn_mm(step: &Move, from: [f64; 2]) -> f64 {
    match step {
        Move::Arc { to, center, clockwise, .. } => arc_mm(from, *to, *center, *clockwise),
        Move::Extrude { to, .. } | Move::Ramp { to, .. } => distance_mm(from, *to),
        _ => 0.0,
    }
}

/// Length of an arc.
pub(crate) fn arc_mm(from: [f64; 2], to: [f64; 2], center: [f64; 2], clockwise: bool) -> f64 {
    let angle = |p: [f64; 2]| real::atan2(p[1] - center[1], p[0] - center[0]);
    let turn = if clockwise { angle(from) - angle(to) } else { angle(to) - angle(from) };
    let sweep = turn.rem_euclid(std::f64::consts::TAU);
    // No turn at all is a whole circle.
    let sweep = if sweep < 1e-9 { std::f64::consts::TAU } else { sweep };
    distance_mm(from, center) * sweep
}
