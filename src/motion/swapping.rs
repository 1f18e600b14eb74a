//! Filament taken out of a nozzle and put in, as moves.

use super::nozzle::Nozzle;
use super::overhang::Grade;
use super::swap::{ARRIVING, FEEDING, PARKING_MM_S, QUICK_MM, SLOWING};
use super::{Move, SwapStep};
use crate::toolpath::{Path, bead};
use crate::units::{Celsius, Mm3, MmPerS, Seconds};
use geometry::distance_mm;

/// Longest that ramming waits for the nozzle to cool down, seconds.
const SETTLING_S: f64 = 1.5;
/// The nozzle stands this far above what it has rammed, millimetres.
const CLEAR_MM: f64 = 0.5;

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
        let area_mm2 = bead::area_mm2(path.width.mean_mm(), path.height_mm);
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
        let lifted_mm = self.layer_z_mm.max(self.z_mm) + self.hop_mm().max(CLEAR_MM);
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
        let places = [self.at, aside];
        for turn in 0..moves {
            if turn > 0 && swap.stamping.0 > 0.0 {
                let stamped_mm = swap.stamping.0 + tube_mm / 2.0;
                self.filament(stamped_mm, swap.stamping_speed);
                self.filament(-stamped_mm, speed);
            }
            if turn + 1 == moves {
                self.moves.extend(warm_again.clone());
            }
            let of_step = |step: u32| MmPerS(first + (last - first) * f64::from(step) / steps);
            self.filament(tube_mm, of_step(2 * turn));
            self.go(places[(turn as usize + 1) % 2]);
            self.filament(-tube_mm, of_step(2 * turn + 1));
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

    /// Puts in the first filament of all, at the place where it is primed.
    pub(super) fn load_first(&mut self) {
        let high = self.settings.swap.high_current;
        let current = |high: bool| Move::Swap(SwapStep::HighCurrent(high));
        self.moves.extend(high.then(|| current(true)));
        self.moves.push(Move::Swap(SwapStep::Take(self.tool)));
        self.load();
        self.moves.extend(high.then(|| current(false)));
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
