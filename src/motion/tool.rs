//! Changes of tool within a layer.

use super::nozzle::Nozzle;
use super::rules::Rules;
use super::{Entry, MotionSettings, Move, SwapStep, ToolChange};
use crate::order::PathVisit;
use crate::toolpath::{LayerPaths, Path, ToolId};
use crate::units::Seconds;

impl Nozzle<'_> {
    /// Takes another tool: the filament is pulled back, or out, and the nozzle lifted. Where it is then is not known, as
    /// scripts may move it. `ram` is laid before.
    pub(super) fn change_tool(&mut self, to: ToolId, ram: Option<&Path>) {
        let before = self.tool;
        let own = self.all.of_tool(to);
        let rules = Rules::new(own, self.rules.index());
        let (hot, nozzle) = (self.rules.nozzle_temperature(), rules.nozzle_temperature());
        let (swaps, was) = (self.settings.swaps(), self.settings);
        // Where the nozzle comes from may be higher.
        let mut lifted_mm = self.layer_z_mm.max(self.z_mm) + self.hop_mm();
        let is_raised = swaps && was.swap.high_current;
        if is_raised {
            self.moves.push(Move::Swap(SwapStep::HighCurrent(true)));
        }
        if let Some(ram) = ram {
            self.ram(ram);
        }
        if swaps {
            let pulled_mm = if ram.is_some() { 0.0 } else { self.pull_back() };
            let aside = ram.and_then(|ram| ram.points.first()).map(|point| point.mm());
            lifted_mm = self.unload(pulled_mm, nozzle, aside);
        } else {
            self.pull_back();
            self.lift(lifted_mm);
        }
        let [x, y] = self.at.unwrap_or_default();
        self.moves.push(Move::ToolChange(Box::new(ToolChange {
            from: before,
            to,
            before: hot,
            nozzle,
            time: own.change_time,
            wait: Seconds(own.shared_heating_s(hot, nozzle)),
            at_mm: [x, y, lifted_mm],
        })));
        // What a single nozzle is given is as far back as what was taken out.
        let is_parked = !own.keeps_filament || self.parked & (1 << to) != 0;
        self.parked = parked(self.parked, before, to, self.settings);
        self.retracted_mm = if is_parked { change_mm(own) } else { own.left_back_mm };
        self.restart_mm = is_parked.then_some(own.retract.change_extra.0);
        (self.settings, self.rules, self.tool) = (own, rules, to);
        let back = self.at.filter(|_| swaps && ram.is_some());
        (self.at, self.positioned, self.island) = (None, false, None);
        if swaps {
            self.go(back);
            self.load();
            self.retracted_mm = 0.0;
        } else if ram.is_some() && was.swap.sensor_off {
            self.moves.push(Move::Swap(SwapStep::Sensor(true)));
        }
        if is_raised {
            self.moves.push(Move::Swap(SwapStep::HighCurrent(false)));
        }
        let disabled = was.advance_returns && ram.is_some();
        if own.pressure_advance > 0.0 && (disabled || own.pressure_advance != was.pressure_advance) {
            let seconds = own.pressure_advance;
            self.moves.push(Move::Swap(SwapStep::PressureAdvance { tool: to, seconds }));
        }
        (self.acceleration, self.bead) = (None, None);
        self.wipe.clear();
        let fan = self.rules.fan(None);
        if fan != self.fan {
            self.moves.push(Move::Fan(fan));
            self.fan = fan;
        }
    }

    /// Pulls the filament back as far as a change asks for; returns how far it is then.
    fn pull_back(&mut self) -> f64 {
        let (whole_mm, usual_mm) = (change_mm(self.settings), self.settings.retract.length.0);
        let before_mm = std::mem::take(&mut self.retracted_mm);
        let mut pulled_mm = before_mm;
        if before_mm <= 0.0 && usual_mm > 0.0 {
            self.retract();
            pulled_mm = usual_mm;
        }
        let length_mm = whole_mm - pulled_mm;
        if length_mm > 0.0 && !(self.settings.retract.firmware && pulled_mm > 0.0) {
            self.moves.push(Move::Retract { length_mm, speed: self.settings.retract.speed });
        }
        whole_mm.max(pulled_mm)
    }
}

/// How far the filament is pulled back at a change: no further than for a travel where it is then taken out.
fn change_mm(settings: &MotionSettings) -> f64 {
    let usual_mm = settings.retract.length.0;
    if settings.keeps_filament { settings.retract.change_length.0.max(usual_mm) } else { usual_mm }
}

/// Which tool a layer leaves in use, and which are put away.
pub(super) fn left(
    layer: &LayerPaths,
    sequence: &[PathVisit],
    from: &Entry,
    settings: &MotionSettings,
) -> (ToolId, u32) {
    let (mut tool, mut away) = (from.tool, from.parked);
    for visit in sequence {
        let next = layer.paths.get(visit.path as usize).and_then(|path| path.tool).unwrap_or(tool);
        if next != tool {
            away = parked(away, tool, next, settings);
            tool = next;
        }
    }
    (tool, away)
}

/// The tools that are put away after a change, a bit each.
fn parked(before: u32, from: ToolId, to: ToolId, settings: &MotionSettings) -> u32 {
    let put_away = if settings.keeps_filament { 1 << from } else { 0 };
    (before | put_away) & !(1 << to)
}
