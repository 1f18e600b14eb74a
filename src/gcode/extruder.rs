//! E to the last digit: the amount of filament that each move feeds.

use super::number::nearest;

/// Digits behind the point of E.
pub(super) const E_DECIMALS: u32 = 5;
/// Ticks of E in a millimetre.
const E_TICKS_PER_MM: f64 = 1e5;

/// Counts filament in ticks of 10⁻⁵ mm, so that rounding neither drifts nor leaks from an extrusion into a
/// retraction.
pub(super) struct Extruder {
    ticks_per_mm3: f64,
    /// Filament extruded so far: what it should be, and what was written.
    owed: f64,
    paid: i64,
    /// Filament retracted at present: what it should be, and what was written.
    pulled: f64,
    pulled_written: i64,
    /// Absolute E.
    pub(super) position: i64,
}

impl Extruder {
    pub(super) fn new(area_mm2: f64) -> Self {
        Self {
            ticks_per_mm3: E_TICKS_PER_MM / area_mm2,
            owed: 0.0,
            paid: 0,
            pulled: 0.0,
            pulled_written: 0,
            position: 0,
        }
    }

    pub(super) fn owe(&mut self, volume_mm3: f64) {
        self.owed += volume_mm3 * self.ticks_per_mm3;
    }

    /// All whole ticks owed.
    pub(super) fn pay(&mut self) -> i64 {
        let delta = (nearest(self.owed) - self.paid).max(0);
        self.paid += delta;
        self.position += delta;
        delta
    }

    /// Ticks (negative) of pulling back.
    pub(super) fn pull(&mut self, length_mm: f64) -> i64 {
        self.pulled += length_mm * E_TICKS_PER_MM;
        let delta = nearest(self.pulled) - self.pulled_written;
        self.pulled_written += delta;
        self.position -= delta;
        -delta
    }

    /// Ticks of pushing forward: exactly what was pulled, and what the length goes beyond it.
    pub(super) fn restore(&mut self, length_mm: f64) -> i64 {
        let extra = length_mm * E_TICKS_PER_MM - self.pulled;
        let delta = self.pulled_written + nearest(extra);
        (self.pulled, self.pulled_written) = (0.0, 0);
        self.position += delta;
        delta
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn rounding_never_drifts_and_every_retraction_is_undone(
            volumes in prop::collection::vec(0.0..0.01f64, 1..200),
            wipes in prop::collection::vec(0.0..0.7f64, 1..5),
        ) {
            let mut extruder = Extruder::new(2.405);
            for volume in &volumes {
                extruder.owe(*volume);
                extruder.pay();
                let before = extruder.position;
                let pulled: i64 = wipes.iter().map(|w| extruder.pull(*w)).sum();
                prop_assert_eq!(extruder.restore(wipes.iter().sum()), -pulled);
                prop_assert_eq!(extruder.position, before);
            }
            let wanted = volumes.iter().sum::<f64>() / 2.405 * E_TICKS_PER_MM;
            prop_assert!((extruder.position as f64 - wanted).abs() <= 0.501);
        }
    }
}
