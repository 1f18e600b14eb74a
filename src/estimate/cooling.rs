//! Small layers are slowed down until they have had time to cool.

use super::{LayerTime, Machine, layer_time};
use crate::motion::{LayerMoves, Move};
use crate::profile::CoolingSettings;
use crate::units::{MmPerS, Seconds};

/// How much longer than asked a slowed layer may take.
const SLACK: f64 = 0.01;

/// Slows a layer's extrusions, all by the same factor, until it lasts `min_layer_time`; none below `min_speed`
/// (those that are slower already stay as they are). Returns the time that the layer takes in the end.
///
/// The factor is bisected over the planner, since short moves never reach their speed and so gain less than
/// their share.
pub fn cool(layer: &mut LayerMoves, settings: &CoolingSettings, machine: &Machine) -> LayerTime {
    let time = layer_time(layer, machine);
    let wanted = settings.min_layer_time;
    if wanted.0 <= 0.0 || time.total() >= wanted || time.printing().0 <= 0.0 {
        return time;
    }
    let full = layer.moves.clone();
    let slowed = |layer: &mut LayerMoves, factor: f64| {
        for (step, full) in layer.moves.iter_mut().zip(&full) {
            slow(step, full, factor, settings.min_speed);
        }
        layer_time(layer, machine)
    };
    // At this factor nothing is left above the least speed.
    let fastest = full.iter().filter_map(speed_of).fold(0.0_f64, f64::max);
    let (mut too_slow, mut too_fast) = ((settings.min_speed.0 / fastest).min(1.0), 1.0);
    let slowest = slowed(layer, too_slow);
    if slowest.total() <= wanted {
        return slowest;
    }
    let mut best = slowest;
    // The first guess is right where no move is limited by acceleration or the least speed.
    let mut factor = time.printing().0 / (wanted - time.total() + time.printing()).0;
    for _ in 0..20 {
        let factor_now =
            if factor > too_slow && factor < too_fast { factor } else { 0.5 * (too_slow + too_fast) };
        let now = slowed(layer, factor_now);
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
    slowed(layer, too_slow);
    best
}

fn speed_of(step: &Move) -> Option<f64> {
    match step {
        Move::Extrude { speed, .. } | Move::Arc { speed, .. } => Some(speed.0),
        _ => None,
    }
}

fn slow(step: &mut Move, full: &Move, factor: f64, least: MmPerS) {
    let Some(at_full) = speed_of(full) else { return };
    if let Move::Extrude { speed, .. } | Move::Arc { speed, .. } = step {
        *speed = MmPerS((at_full * factor).max(least.0).min(at_full));
    }
}
