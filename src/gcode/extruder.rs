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
    /// Filament extruded so far: exact and as written.
    extruded: f64,
    extruded_written: i64,
    /// Filament retracted at present: exact and as written.
    retracted: f64,
    retracted_written: i64,
    /// Absolute E.
    pub(super) position: i64,
}

impl Extruder {
    pub(super) fn new(area_mm2: f64) -> Self {
        Self {
            ticks_per_mm3: E_TICKS_PER_MM / area_mm2,
            extruded: 0.0,
            extruded_written: 0,
            retracted: 0.0,
            retracted_written: 0,
            position: 0,
        }
    }

    /// Adds what a bead extrudes.
    pub(super) fn add(&mut self, volume_mm3: f64) {
        self.extruded += volume_mm3 * self.ticks_per_mm3;
    }

    /// Takes the whole ticks that are still to be written.
    pub(super) fn take(&mut self) -> i64 {
        let delta = (nearest(self.extruded) - self.extruded_written).max(0);
        self.extruded_written += delta;
        self.position += delta;
        delta
    }

    /// Ticks (negative) of a retraction.
    pub(super) fn retract(&mut self, length_mm: f64) -> i64 {
        self.retracted += length_mm * E_TICKS_PER_MM;
        let delta = nearest(self.retracted) - self.retracted_written;
        self.retracted_written += delta;
        self.position -= delta;
        -delta
    }

    /// Ticks of filament moved in place, forward or back, beside beads and retractions.
    pub(super) fn feed(&mut self, length_mm: f64) -> i64 {
        let delta = nearest(length_mm * E_TICKS_PER_MM);
        self.position += delta;
        delta
    }

    /// Ticks of an unretraction: exactly what was retracted, and what the length exceeds it by.
    pub(super) fn unretract(&mut self, length_mm: f64) -> i64 {
        let extra = length_mm * E_TICKS_PER_MM - self.retracted;
        let delta = self.retracted_written + nearest(extra);
        (self.retracted, self.retracted_written) = (0.0, 0);
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
                extruder.add(*volume);
                extruder.take();
                let before = extruder.position;
                let retracted: i64 = wipes.iter().map(|w| extruder.retract(*w)).sum();
                prop_assert_eq!(extruder.unretract(wipes.iter().sum()), -retracted);
                prop_assert_eq!(extruder.position, before);
            }
            let wanted = volumes.iter().sum::<f64>() / 2.405 * E_TICKS_PER_MM;
            prop_assert!((extruder.position as f64 - wanted).abs() <= 0.501);
        }
    }
}
