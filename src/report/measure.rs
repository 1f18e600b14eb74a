//! Lengths and counts of planned moves, as the G-code will show them.

use crate::motion::{LayerMoves, Move};

use super::Measures;

/// Measures a layer. `first` says that nothing was extruded before it: what precedes its first bead does not count.
/// Time, bound and filament length are left to the caller.
pub fn measure_layer(layer: &LayerMoves, first: bool) -> Measures {
    let mut m = Measures::default();
    let mut at = layer.from.xy.unwrap_or_default();
    let mut bead_end = at;
    let mut started = !first;
    let mut travelling = false;
    for step in &layer.moves {
        match step {
            Move::Travel { to, .. } | Move::Wipe { to, .. } => {
                let way_mm = distance(at, *to);
                if matches!(step, Move::Wipe { .. }) && !travelling {
                    m.retractions += usize::from(started);
                }
                if started && way_mm > 0.0 {
                    m.travel_mm += way_mm;
                    travelling = true;
                }
                at = *to;
            }
            Move::Extrude { to, volume, .. } | Move::Arc { to, volume, .. } => {
                if travelling && started {
                    m.travels += 1;
                    m.link_mm += distance(bead_end, at);
                }
                travelling = false;
                started = true;
                m.print_mm += match step {
                    Move::Arc { center, clockwise, .. } => arc_length(at, *to, *center, *clockwise),
                    _ => distance(at, *to),
                };
                m.volume_mm3 += volume.0;
                at = *to;
                bead_end = at;
            }
            Move::Retract { .. } => m.retractions += usize::from(started),
            _ => {}
        }
    }
    m.total_mm = m.print_mm + m.travel_mm;
    m
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (b[0] - a[0]).hypot(b[1] - a[1])
}

fn arc_length(from: [f64; 2], to: [f64; 2], center: [f64; 2], clockwise: bool) -> f64 {
    let angle = |p: [f64; 2]| (p[1] - center[1]).atan2(p[0] - center[0]);
    let sweep = if clockwise { angle(from) - angle(to) } else { angle(to) - angle(from) };
    distance(from, center) * sweep.rem_euclid(std::f64::consts::TAU)
}
