//! The extra amount after a retraction, fed with the beginning of the next bead so that it leaves no blob.

use super::Move;
use super::sums::drawn_mm;
use crate::units::{Mm3, MmPerS};

/// Distance over which it is fed.
const PRIME_MM: f64 = 2.0;

/// Adds a volume (negative: removes it, down to nothing) to the first lines of the bead that begins at `from` with
/// `moves[first]`, in proportion to their own volumes. A line that is longer is cut. What then holds more is drawn at
/// the speed that is `melted` for its cross-section, mm².
pub(super) fn prime(
    moves: &mut Vec<Move>,
    first: usize,
    from: [f64; 2],
    extra_mm3: f64,
    melted: impl Fn(MmPerS, f64) -> MmPerS,
) {
    if extra_mm3 == 0.0 {
        return;
    }
    let (mut at, mut left_mm, mut held_mm3, mut end) = (from, PRIME_MM, 0.0, first);
    while let Some(step) = moves.get(end).filter(|_| left_mm > 0.0).cloned() {
        let (line, length_mm) = (matches!(step, Move::Extrude { .. }), drawn_mm(&step, at));
        if let Move::Extrude { to, volume, speed }
        | Move::Ramp { to, volume, speed, .. }
        | Move::Arc { to, volume, speed, .. } = step
        {
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
    let factor = (1.0 + extra_mm3 / held_mm3.max(f64::MIN_POSITIVE)).max(0.0);
    at = from;
    for step in &mut moves[first..end] {
        let length_mm = drawn_mm(step, at);
        if let Move::Extrude { to, volume, speed }
        | Move::Ramp { to, volume, speed, .. }
        | Move::Arc { to, volume, speed, .. } = step
        {
            volume.0 *= factor;
            if factor > 1.0 {
                *speed = melted(*speed, volume.0 / length_mm);
            }
            at = *to;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_extra_amount_is_fed_on_the_first_two_millimetres() {
        let line =
            |x: f64, volume: f64| Move::Extrude { to: [x, 0.0], volume: Mm3(volume), speed: MmPerS(40.0) };
        let bead = vec![line(1.0, 0.1), line(11.0, 1.0), line(21.0, 1.0)];
        let mut more = bead.clone();
        prime(&mut more, 0, [0.0; 2], 0.2, |speed, _| speed);
        assert_eq!(more, [line(1.0, 0.2), line(2.0, 0.2), line(11.0, 0.9), line(21.0, 1.0)]);
        let mut melted = bead.clone();
        prime(&mut melted, 0, [0.0; 2], 0.2, |speed, area_mm2| MmPerS(speed.0.min(6.0 / area_mm2)));
        let speed = |step: &Move| if let Move::Extrude { speed, .. } = step { speed.0 } else { f64::NAN };
        assert_eq!(melted.iter().map(speed).collect::<Vec<_>>(), [30.0, 30.0, 40.0, 40.0]);
        let mut less = bead;
        prime(&mut less, 0, [0.0; 2], -1.0, |speed, _| speed);
        assert_eq!(less[..2], [line(1.0, 0.0), line(2.0, 0.0)]);
    }
}
