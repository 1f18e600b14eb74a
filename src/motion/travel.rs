//! The way from the end of one bead to the start of the next: straight, retracted where it is long.

use super::bead::distance;
use super::plan::Nozzle;
use super::{MotionSettings, Move};
use crate::units::MmPerS;

impl Nozzle<'_> {
    /// Moves to where the next bead starts, at the height of the layer.
    ///
    /// A travel *longer* than `retract.min_travel` (or from an unknown place) is retracted. The nozzle climbs to the
    /// next layer on the way, or before it where the way is no longer than high; never does it go down, or to where
    /// something may be in its way, before it is above.
    pub(super) fn travel(&mut self, to: [f64; 2], pause: bool) {
        let retract = &self.settings.retract;
        let arriving = !self.positioned || self.z_mm != self.layer_z_mm;
        let length_mm = self.at.map(|at| distance(at, to));
        if length_mm == Some(0.0) && !arriving && !pause {
            return;
        }
        let far = length_mm.is_none_or(|length_mm| length_mm > retract.min_travel.0);
        let retracted = (far || pause) && retract.length.0 > 0.0;
        if retracted {
            self.retract();
        }
        if pause {
            self.moves.push(Move::Pause);
        }
        let hop_mm = if retracted { retract.z_hop.0.max(0.0) } else { 0.0 };
        let climb_mm = self.layer_z_mm - self.z_mm;
        let on_the_way = length_mm.is_some_and(|length_mm| length_mm > climb_mm) && climb_mm > 0.0;
        if on_the_way && !pause && hop_mm <= 0.0 {
            self.accelerate(None);
            let speed = self.climb_speed(length_mm.unwrap_or(0.0), climb_mm);
            self.moves.push(Move::Climb { to, z_mm: self.layer_z_mm, speed });
        } else {
            if arriving || pause || hop_mm > 0.0 {
                self.lift(self.layer_z_mm + hop_mm);
            }
            self.accelerate(None);
            self.moves.push(Move::Travel { to, speed: self.settings.speed.travel });
        }
        self.positioned = true;
        if hop_mm > 0.0 {
            self.lift(self.layer_z_mm);
        }
        if retracted {
            self.moves.push(Move::Unretract {
                length_mm: retract.length.0 + retract.extra.0.max(0.0),
                speed: retract.unretract_speed,
            });
        }
        self.at = Some(to);
        self.z_mm = self.layer_z_mm;
    }

    /// The travel speed, unless Z would be faster than it may.
    fn climb_speed(&self, length_mm: f64, climb_mm: f64) -> MmPerS {
        let speed = &self.settings.speed;
        MmPerS(speed.travel.0.min(speed.z.0 * length_mm.hypot(climb_mm) / climb_mm))
    }

    fn lift(&mut self, z_mm: f64) {
        self.moves.push(Move::Lift { z_mm, speed: self.settings.speed.z });
    }

    /// Pulls the filament back: on the way back over the last bead as far as `retract.wipe` says, the filament
    /// no faster than `retract.speed`; in place where nothing was printed yet on this layer.
    fn retract(&mut self) {
        let retract = &self.settings.retract;
        let (length_mm, speed) = (retract.length.0, retract.speed);
        let way = if retract.firmware { Vec::new() } else { wipe_way(&self.trail, retract.wipe.0) };
        let way_mm: f64 = way.windows(2).map(|w| distance(w[0], w[1])).sum();
        if way_mm <= 0.0 {
            self.moves.push(Move::Retract { length_mm, speed });
            return;
        }
        let wipe_speed = wipe_speed(self.settings, way_mm);
        for w in way.windows(2) {
            let share = distance(w[0], w[1]) / way_mm;
            self.moves.push(Move::Wipe { to: w[1], length_mm: length_mm * share, speed: wipe_speed });
        }
    }
}

/// The nozzle's speed that takes as long over the wipe as the retraction would take in place, at most the
/// travel speed.
fn wipe_speed(settings: &MotionSettings, way_mm: f64) -> MmPerS {
    let speed = way_mm * settings.retract.speed.0 / settings.retract.length.0;
    MmPerS(speed.min(settings.speed.travel.0))
}

/// The last `wipe_mm` of a trail, walked backwards; all of it where it is shorter.
fn wipe_way(trail: &[[f64; 2]], wipe_mm: f64) -> Vec<[f64; 2]> {
    let mut way: Vec<[f64; 2]> = Vec::new();
    let mut left_mm = wipe_mm;
    for &p in trail.iter().rev() {
        let Some(&from) = way.last() else {
            way.push(p);
            continue;
        };
        if left_mm <= 0.0 {
            break;
        }
        let length_mm = distance(from, p);
        if length_mm > left_mm {
            let t = left_mm / length_mm;
            way.push([from[0] + t * (p[0] - from[0]), from[1] + t * (p[1] - from[1])]);
            break;
        }
        if length_mm > 0.0 {
            way.push(p);
            left_mm -= length_mm;
        }
    }
    way
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wipe_goes_back_over_the_trail_as_far_as_it_is_long() {
        let trail = [[0.0, 0.0], [3.0, 0.0], [3.0, 1.0]];
        assert_eq!(wipe_way(&trail, 2.0), [[3.0, 1.0], [3.0, 0.0], [2.0, 0.0]]);
        assert_eq!(wipe_way(&trail, 99.0), [[3.0, 1.0], [3.0, 0.0], [0.0, 0.0]]);
        assert!(wipe_way(&[], 1.0).is_empty());
    }
}
