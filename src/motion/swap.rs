//! What a filament goes through at a change of tool of a single nozzle: its tip is shaped, it is pulled to where it is parked, and
//! the next one is fed forward from there.
//!
//! The steps are those that PrusaSlicer's wipe tower made usual, and that firmware of filament changers expects.

use crate::options::section;
use crate::units::{Celsius, Mm, MmPerS, Ratio, Seconds};

section! {
    /// `[swap]`: what a filament goes through where a single nozzle changes it. See [tools](tools.md#swapping-filament).
    SwapSettings {
        /// How far behind the nozzle's tip a filament is parked; 0: script or machine take it out and put it in.
        parking: Mm = Mm(0.0); 0.0..=1000.0,
        /// How much further than from there the next one is fed.
        extra_load: Mm = Mm(0.0); -500.0..=500.0,
        /// Middle of the tube in which the tip cools, behind the nozzle's tip; 0: there is none.
        cooling_tube: Mm = Mm(0.0); 0.0..=1000.0,
        /// Length of that tube.
        cooling_tube_length: Mm = Mm(0.0); 0.0..=500.0,
        /// Speed of the first 15 mm on the way out.
        unload_start_speed: MmPerS = MmPerS(100.0); 0.1..=500.0,
        /// Speed of the rest, which is slower towards the end.
        unload_speed: MmPerS = MmPerS(20.0); 0.1..=500.0,
        /// Speed of the first fifth on the way in.
        load_start_speed: MmPerS = MmPerS(3.0); 0.1..=500.0,
        /// Speed of the rest; a tenth of it before the nozzle.
        load_speed: MmPerS = MmPerS(28.0); 0.1..=500.0,
        /// How often the tip is moved to and fro in the tube.
        cooling_moves: u32 = 4; 0..=20,
        /// Speed of the first and of the last of these moves.
        cooling_speed: [MmPerS; 2] = [MmPerS(2.2), MmPerS(3.4)]; 0.1..=500.0,
        /// How far beyond the tube the tip is pushed into the nozzle between two of them; 0: not at all.
        stamping: Mm = Mm(0.0); 0.0..=500.0,
        /// Speed of that.
        stamping_speed: MmPerS = MmPerS(20.0); 0.1..=500.0,
        /// Wait before the filament is parked.
        delay: Seconds = Seconds(0.0); 0.0..=600.0,
        /// Ramming: flows that shape the tip, one after the other, laid into the prime tower before the tool is left; empty: none.
        ramming: Vec<f64> = Vec::new(); 0.01..=1000.0, "mm³/s",
        /// How long each of these flows lasts.
        ramming_step: Seconds = Seconds(0.25); 0.01..=60.0,
        /// Width of what is rammed, of the tower's lines.
        ramming_width: Ratio = Ratio(1.2); 0.5..=5.0,
        /// Distance of these lines, of their width.
        ramming_spacing: Ratio = Ratio(1.0); 0.5..=5.0,
        /// How much cooler the nozzle is while ramming.
        ramming_cooler: Celsius = Celsius(0.0); 0.0..=100.0,
        /// Switch the filament sensor off meanwhile (M591).
        sensor_off: bool = false,
        /// Raise the current of the extruder's motor meanwhile, for quick ramming (M907 E750, and E550 after it).
        high_current: bool = false,
    }
}

impl SwapSettings {
    /// What ramming extrudes, mm³.
    pub fn rammed_mm3(&self) -> f64 {
        self.ramming.iter().sum::<f64>() * self.ramming_step.0
    }

    /// How long a filament takes on its way out, without what ramps take, seconds.
    pub(crate) fn unload_s(&self) -> f64 {
        let rammed_s = self.ramming.len() as f64 * self.ramming_step.0;
        let cooled_mm = (self.cooling_tube.0 + self.cooling_tube_length.0 / 2.0).max(QUICK_MM);
        let slowing: f64 = SLOWING.iter().map(|[share, slower]| share / slower).sum();
        let [first, last] = self.cooling_speed.map(|speed| speed.0);
        let cooled_s = f64::from(self.cooling_moves) * 4.0 * self.cooling_tube_length.0 / (first + last);
        rammed_s
            + QUICK_MM / self.unload_start_speed.0
            + (cooled_mm - QUICK_MM) * slowing / self.unload_speed.0
            + cooled_s
            + (self.parking.0 - cooled_mm).abs() / self.unload_speed.0.max(PARKING_MM_S)
            + self.delay.0
    }

    /// How long a filament takes on its way in.
    pub(crate) fn load_s(&self) -> f64 {
        let way_mm = (self.parking.0 + self.extra_load.0).abs();
        let [start, way, end] = FEEDING.map(|share| share * way_mm);
        start / self.load_start_speed.0 + way / self.load_speed.0 + end / (ARRIVING * self.load_speed.0)
    }
}

/// The quick first part of the way out, in which the tip leaves the melt, millimetres.
pub(super) const QUICK_MM: f64 = 15.0;
/// The way from there into the tube: shares of its length and of the speed.
pub(super) const SLOWING: [[f64; 2]; 3] = [[0.7, 1.0], [0.2, 0.5], [0.1, 0.3]];
/// Speed of the way from the tube to where it is parked, at least.
pub(super) const PARKING_MM_S: f64 = 33.0;
/// The way in.
pub(super) const FEEDING: [f64; 3] = [0.2, 0.7, 0.1];
/// Share of the speed at which the filament arrives at the nozzle.
pub(super) const ARRIVING: f64 = 0.1;
