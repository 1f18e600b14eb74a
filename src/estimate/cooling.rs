//! Small layers are slowed down until they have had time to cool.

use super::{LayerTime, Machine, layer_time};
use crate::motion::CoolingSettings;
use crate::motion::{LayerMoves, Move};
use crate::toolpath::Role;
use crate::units::{MmPerS, Seconds};

/// How much longer than asked a slowed layer may take.
const SLACK: f64 = 0.01;
/// Share of the least time that a part of a layer takes by itself, however long other tools print meanwhile.
const OWN_SHARE: f64 = 0.5;

/// Slows a layer's extrusions until it lasts `min_layer_time`; none below `min_speed` (those that are slower already
/// stay as they are). Outermost walls, where a change of speed shows, keep theirs until all the rest is at the
/// least speed. Returns the time that the layer takes in the end.
///
/// The layer as a whole counts, however far apart its islands are: what was printed on one has the time of all
/// others to cool. `elsewhere`: what other tools take for each layer of a block, if this is but the part of one tool.
///
/// All that is slowed together is slowed by one factor. It is bisected over the planner, since short moves never
/// reach their speed and so gain less than their share.
pub fn cool(
    layer: &mut LayerMoves,
    elsewhere: Seconds,
    settings: &CoolingSettings,
    machine: &Machine,
) -> LayerTime {
    let least = settings.min_layer_time;
    let wanted = Seconds((least.0 - elsewhere.0).max(OWN_SHARE * least.0));
    let mut time = layer_time(layer, machine);
    if wanted.0 <= 0.0 || time.total() >= wanted {
        return time;
    }
    let outer = outermost(&layer.moves);
    for chosen in [false, true] {
        let moves: Vec<usize> = (0..outer.len()).filter(|&i| outer[i] == Some(chosen)).collect();
        if time.total() >= wanted || moves.is_empty() {
            continue;
        }
        let spared = time.role(Role::ExternalPerimeter) + time.role(Role::OverhangPerimeter);
        let printing = if chosen { spared } else { time.printing() - spared };
        time = Slowing { layer, moves, wanted, least: settings.min_speed, machine }.stretch(time, printing);
    }
    time
}

/// Of each extrusion whether it is of an outermost wall, or one that hangs over; `None` of other moves.
fn outermost(moves: &[Move]) -> Vec<Option<bool>> {
    let mut outer = false;
    let kinds = moves.iter().map(|step| {
        if let Move::Bead { role, .. } = step {
            outer = role.is_outer_wall();
        }
        speed_of(step).map(|_| outer)
    });
    kinds.collect()
}

/// Extrusions of a layer that are slowed together.
struct Slowing<'a> {
    layer: &'a mut LayerMoves,
    moves: Vec<usize>,
    wanted: Seconds,
    /// The least speed.
    least: MmPerS,
    machine: &'a Machine,
}

impl Slowing<'_> {
    /// Slows these moves, which take `printing` of the layer's `time`, until it lasts long enough or the lowest speed
    /// is reached.
    fn stretch(mut self, time: LayerTime, printing: Seconds) -> LayerTime {
        let wanted = self.wanted;
        let full: Vec<f64> = self.moves.iter().filter_map(|&i| speed_of(&self.layer.moves[i])).collect();
        // At this factor nothing is left above the least speed.
        let fastest = full.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let (mut too_slow, mut too_fast) = ((self.least.0 / fastest).min(1.0), 1.0);
        let slowest = self.slowed(&full, too_slow);
        if slowest.total() <= wanted {
            return slowest;
        }
        let mut best = slowest;
        // The first guess is right where no move is limited by acceleration or the least speed.
        let mut factor = printing.0 / (wanted - time.total() + printing).0;
        for _ in 0..20 {
            let factor_now =
                if factor > too_slow && factor < too_fast { factor } else { 0.5 * (too_slow + too_fast) };
            let now = self.slowed(&full, factor_now);
            if now.total() >= wanted {
                (too_slow, best) = (factor_now, now);
                if now.total() <= Seconds(wanted.0 * (1.0 + SLACK)) {
                    return best;
                }
            } else {
                too_fast = factor_now;
            }
            factor = f64::NAN;
        }
        self.slowed(&full, too_slow);
        best
    }

    /// The layer's time with these moves at this share of their full speed.
    fn slowed(&mut self, full: &[f64], factor: f64) -> LayerTime {
        let least = self.least.0;
        for (&i, &at_full) in self.moves.iter().zip(full) {
            if let Move::Extrude { speed, .. } | Move::Ramp { speed, .. } | Move::Arc { speed, .. } =
                &mut self.layer.moves[i]
            {
                *speed = MmPerS((at_full * factor).max(least).min(at_full));
            }
        }
        layer_time(self.layer, self.machine)
    }
}

fn speed_of(step: &Move) -> Option<f64> {
    match step {
        Move::Extrude { speed, .. } | Move::Ramp { speed, .. } | Move::Arc { speed, .. } => Some(speed.0),
        _ => None,
    }
}
