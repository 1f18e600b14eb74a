//! What is fed beyond what was pulled back: with the beginning of the next bead, so that it leaves no blob.

use super::Move;
use crate::geom::distance_mm;
use crate::units::{Mm3, Mm3PerS};

/// Way on which it is fed.
const PRIME_MM: f64 = 2.0;

/// Adds a volume (less than 0: takes it away, as far as there is any) to the first lines of a bead that begins at
/// `from` with `moves[first]`, in proportion to what they hold. A line that is longer is cut. What is more than the hot
/// end melts (0: not known) is drawn more slowly.
pub(super) fn prime(moves: &mut Vec<Move>, first: usize, from: [f64; 2], owed_mm3: f64, max_flow: Mm3PerS) {
    if owed_mm3 == 0.0 {
        return;
    }
    let (mut at, mut left_mm, mut held_mm3, mut end) = (from, PRIME_MM, 0.0, first);
    while let Some(step) = moves.get(end).filter(|_| left_mm > 0.0).cloned() {
        let line = matches!(step, Move::Extrude { .. });
        if let Move::Extrude { to, volume, speed }
        | Move::Ramp { to, volume, speed, .. }
        | Move::Arc { to, volume, speed, .. } = step
        {
            let length_mm = distance_mm(at, to);
            let share = if line { (left_mm / length_mm).min(1.0) } else { 1.0 };
            if share < 1.0 {
                let cut = [0, 1].map(|i| at[i] + share * (to[i] - at[i]));
                moves[end] = Move::Extrude { to: cut, volume: Mm3(share * volume.0), speed };
                moves.insert(end + 1, Move::Extrude { to, volume: Mm3((1.0 - share) * volume.0), speed });
            }
            held_mm3 += share * volume.0;
            left_mm -= length_mm;
            at = to;
        }
        end += 1;
    }
    let factor = (1.0 + owed_mm3 / held_mm3.max(f64::MIN_POSITIVE)).max(0.0);
    at = from;
    for step in &mut moves[first..end] {
        if let Move::Extrude { to, volume, speed }
        | Move::Ramp { to, volume, speed, .. }
        | Move::Arc { to, volume, speed, .. } = step
        {
            volume.0 *= factor;
            let melted = max_flow.0 * distance_mm(at, *to) / volume.0;
            if factor > 1.0 && max_flow.0 > 0.0 && melted < speed.0 {
                speed.0 = melted;
            }
            at = *to;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::MmPerS;

    #[test]
    fn what_is_owed_is_fed_on_the_first_two_millimetres() {
        let line =
            |x: f64, volume: f64| Move::Extrude { to: [x, 0.0], volume: Mm3(volume), speed: MmPerS(40.0) };
        let bead = vec![line(1.0, 0.1), line(11.0, 1.0), line(21.0, 1.0)];
        let mut more = bead.clone();
        prime(&mut more, 0, [0.0; 2], 0.2, Mm3PerS(0.0));
        assert_eq!(more, [line(1.0, 0.2), line(2.0, 0.2), line(11.0, 0.9), line(21.0, 1.0)]);
        let mut melted = bead.clone();
        prime(&mut melted, 0, [0.0; 2], 0.2, Mm3PerS(6.0));
        let speed = |step: &Move| if let Move::Extrude { speed, .. } = step { speed.0 } else { f64::NAN };
        assert_eq!(melted.iter().map(speed).collect::<Vec<_>>(), [30.0, 30.0, 40.0, 40.0]);
        let mut less = bead;
        prime(&mut less, 0, [0.0; 2], -1.0, Mm3PerS(0.0));
        assert_eq!(less[..2], [line(1.0, 0.0), line(2.0, 0.0)]);
    }
}
