//! Filament taken out of a nozzle and put in at a change of tool: its tip is shaped, it is pulled to where it is parked, and
//! the next one is fed forward from there.
//!
//! The steps are those that PrusaSlicer's wipe tower made usual, and that firmware of filament changers expects.

use crate::options::section;
use crate::toolpath::{Path, bead};
use crate::units::{Celsius, Mm, MmPerS, Ratio, Seconds};
use geometry::distance_mm;

use super::bead::mean_width_mm;
use super::nozzle::Nozzle;
use super::overhang::Grade;
use super::{MotionSettings, Move, SwapStep};
use crate::units::Mm3;

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
const QUICK_MM: f64 = 15.0;
/// The way from there into the tube: shares of its length and of the speed.
const SLOWING: [[f64; 2]; 3] = [[0.7, 1.0], [0.2, 0.5], [0.1, 0.3]];
/// Speed of the way from the tube to where it is parked, at least.
const PARKING_MM_S: f64 = 33.0;
/// The way in.
const FEEDING: [f64; 3] = [0.2, 0.7, 0.1];
/// Share of the speed at which the filament arrives at the nozzle.
const ARRIVING: f64 = 0.1;
/// Longest that ramming waits for the nozzle to cool down, seconds.
const SETTLING_S: f64 = 1.5;
/// The nozzle stands this far above what it has rammed, millimetres.
const CLEAR_MM: f64 = 0.5;

impl MotionSettings {
    /// Whether a filament is taken out here, and not by a script.
    pub(crate) fn swaps(&self) -> bool {
        !self.keeps_filament && self.swap.parking.0 > 0.0
    }
}

impl Nozzle<'_> {
    /// Extrudes along a path of the prime tower, at the flows that shape the tip.
    pub(super) fn ram(&mut self, path: &Path) {
        let Some(first) = path.points.first() else { return };
        self.travel(first.mm(), None, None);
        self.begin(path, Grade::Held);
        let swap = &self.settings.swap;
        if swap.sensor_off {
            self.moves.push(Move::Swap(SwapStep::Sensor(false)));
        }
        if self.settings.advance_returns {
            self.moves.push(Move::Swap(SwapStep::PressureAdvance { tool: self.tool, seconds: 0.0 }));
        }
        if swap.ramming_cooler.0 > 0.0 {
            let cooler = Celsius(self.rules.nozzle_temperature().0 - swap.ramming_cooler.0);
            self.moves.push(Move::Nozzle(cooler));
            self.moves.push(Move::Swap(SwapStep::Wait(Seconds(SETTLING_S))));
        }
        let area_mm2 = bead::area_mm2(mean_width_mm(&path.width), path.height_mm);
        let mut flows = swap.ramming.iter();
        let (mut flow, mut left_mm3) = (0.0, 0.0);
        for pair in path.points.windows(2) {
            let [from, to] = [pair[0].mm(), pair[1].mm()];
            let (whole_mm, mut gone_mm) = (distance_mm(from, to), 0.0);
            while whole_mm - gone_mm > 1e-6 {
                if left_mm3 <= 1e-9 {
                    flow = flows.next().copied().unwrap_or(flow);
                    left_mm3 = flow * swap.ramming_step.0;
                }
                let mm3 = left_mm3.min((whole_mm - gone_mm) * area_mm2);
                (left_mm3, gone_mm) = (left_mm3 - mm3, gone_mm + mm3 / area_mm2);
                let share = (gone_mm / whole_mm).min(1.0);
                let at = [0, 1].map(|i| from[i] + share * (to[i] - from[i]));
                self.moves.push(Move::Extrude { to: at, volume: Mm3(mm3), speed: MmPerS(flow / area_mm2) });
            }
        }
        self.at = path.points.last().map(|point| point.mm());
        self.wipe.clear();
    }

    /// Takes the filament out as far as it is parked, the first `pulled_mm` of which is done; `next`: the temperature of the
    /// one that follows. `aside` is where the nozzle goes between while the tip cools. Returns the height it is lifted to.
    pub(super) fn unload(&mut self, pulled_mm: f64, next: Celsius, aside: Option<[f64; 2]>) -> f64 {
        let swap = self.settings.swap.clone();
        let [speed, quick] = [swap.unload_speed, swap.unload_start_speed];
        let tube_mm = swap.cooling_tube_length.0;
        let cooled_mm = swap.cooling_tube.0 + tube_mm / 2.0;
        self.filament(-(QUICK_MM - pulled_mm), quick);
        let lifted_mm = self.layer_z_mm + self.hop_mm().max(CLEAR_MM);
        self.lift(lifted_mm);
        let mut out_mm = QUICK_MM;
        if cooled_mm > QUICK_MM {
            for [share, slower] in SLOWING {
                self.filament(-share * (cooled_mm - QUICK_MM), MmPerS(slower * speed.0));
            }
            out_mm = cooled_mm;
        }
        let warm_again = (swap.ramming_cooler.0 > 0.0).then_some(Move::Nozzle(next));
        let moves = if cooled_mm > QUICK_MM { swap.cooling_moves } else { 0 };
        let [first, last] = swap.cooling_speed.map(|speed| speed.0);
        let steps = f64::from((2 * moves).saturating_sub(1).max(1));
        let home = self.at;
        for turn in 0..moves {
            if turn > 0 && swap.stamping.0 > 0.0 {
                let stamped_mm = swap.stamping.0 + tube_mm / 2.0;
                self.go(aside);
                self.filament(stamped_mm, swap.stamping_speed);
                self.filament(-stamped_mm, speed);
                self.go(home);
            }
            if turn + 1 == moves {
                self.moves.extend(warm_again.clone());
            }
            let of_step = |step: u32| MmPerS(first + (last - first) * f64::from(step) / steps);
            self.filament(tube_mm, of_step(2 * turn));
            self.go(aside);
            self.filament(-tube_mm, of_step(2 * turn + 1));
            self.go(home);
        }
        if moves == 0 {
            self.moves.extend(warm_again);
        }
        if swap.delay.0 > 0.0 {
            self.moves.push(Move::Swap(SwapStep::Wait(swap.delay)));
        }
        self.filament(out_mm - swap.parking.0, MmPerS(PARKING_MM_S.max(speed.0)));
        if swap.sensor_off {
            self.moves.push(Move::Swap(SwapStep::Sensor(true)));
        }
        lifted_mm
    }

    /// Feeds the filament that was put in as far as the nozzle.
    pub(super) fn load(&mut self) {
        let swap = self.settings.swap.clone();
        let way_mm = swap.parking.0 + swap.extra_load.0;
        let speeds = [swap.load_start_speed, swap.load_speed, MmPerS(ARRIVING * swap.load_speed.0)];
        for (share, speed) in FEEDING.into_iter().zip(speeds) {
            self.filament(share * way_mm, speed);
        }
    }

    /// Moves filament in place, forward or back.
    fn filament(&mut self, length_mm: f64, speed: MmPerS) {
        if length_mm.abs() > 1e-9 {
            self.moves.push(Move::Swap(SwapStep::Filament { length_mm, speed }));
        }
    }

    pub(super) fn go(&mut self, to: Option<[f64; 2]>) {
        if let Some(to) = to.filter(|to| self.at != Some(*to)) {
            self.moves.push(Move::Travel { to, speed: self.settings.speed.travel });
            self.at = Some(to);
        }
    }
}
