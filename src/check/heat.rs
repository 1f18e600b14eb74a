//! Heaters: hot before filament moves, off at the end.

use super::fault::Kind;
use super::report::Found;
use super::rule::{LineContext, Rule};

/// No filament flows below this; firmwares ask for 170 °C unless configured otherwise.
const COLD_C: f64 = 100.0;
/// Number of nozzles that are distinguished.
const NOZZLES: usize = 16;

/// Checks temperatures.
#[derive(Default)]
pub(super) struct Heat {
    /// Targets, where the file has set them.
    nozzles: [Option<f64>; NOZZLES],
    /// The heater of each tool, by its number: filaments of one nozzle share one.
    heaters: [Option<usize>; NOZZLES],
    /// Heaters that were let cool down while another tool printed, and not waited for since.
    idle: [bool; NOZZLES],
    tool: usize,
    bed: f64,
    /// Whether something has waited for the nozzle.
    awaited: bool,
    /// Whether the printer may have heated by itself: a macro, a command that this is not aware of, UltiGCode.
    elsewhere: bool,
    /// Whether the firmware has been allowed to extrude cold.
    cold_allowed: bool,
    /// Whether a fault of waiting, or of heating, has been reported.
    reported: [bool; 2],
    begun: bool,
    /// The last line, and its layer.
    last: (usize, Option<usize>),
    /// Whether a macro comes after the last bead: it may turn heaters off.
    macro_at_end: bool,
}

impl Rule for Heat {
    fn check_line(&mut self, seen: &LineContext<'_>, found: &mut Found) {
        self.last = (seen.line.number, seen.context.layer);
        match seen.stroke() {
            Some(stroke) => {
                if stroke.fresh_mm > 1e-9 {
                    self.extrude(seen, found);
                }
                if stroke.extrudes() {
                    (self.begun, self.macro_at_end) = (true, false);
                }
            }
            None => self.apply(seen),
        }
    }

    fn end(&mut self, found: &mut Found) {
        if !self.begun || self.macro_at_end {
            return;
        }
        let nozzle = self.nozzles.iter().flatten().copied().fold(0.0, f64::max);
        for (what, celsius) in [("nozzle", nozzle), ("bed", self.bed)] {
            if celsius > 0.0 {
                let (line, layer) = self.last;
                found
                    .add(Kind::HeaterLeftOn, line, layer, || format!("the {what} is set to {celsius:.0} °C"));
            }
        }
    }
}

impl Heat {
    /// The heater that a tool prints with.
    fn heater(&self, tool: usize) -> usize {
        self.heaters[tool].unwrap_or(tool)
    }

    fn extrude(&mut self, seen: &LineContext<'_>, found: &mut Found) {
        if self.cold_allowed {
            return;
        }
        let heater = self.heater(self.tool);
        match self.nozzles[heater] {
            Some(celsius) if self.idle[heater] => {
                seen.fault(found, Kind::ColdExtrusion, || {
                    format!(
                        "tool {} was let cool down, and {celsius:.0} °C not waited for: {}",
                        self.tool,
                        seen.text()
                    )
                });
            }
            Some(celsius) if celsius < COLD_C => {
                seen.fault(found, Kind::ColdExtrusion, || format!("at {celsius:.0} °C: {}", seen.text()));
            }
            Some(celsius) => {
                if !self.awaited && !self.elsewhere && !std::mem::replace(&mut self.reported[0], true) {
                    seen.fault(found, Kind::NotAwaited, || format!("{celsius:.0} °C is set, not waited for"));
                }
            }
            None if self.elsewhere || seen.state.volumetric => {
                if !std::mem::replace(&mut self.reported[1], true) {
                    seen.fault(found, Kind::NoTemperature, || "the printer or a macro has to".into());
                }
            }
            None => seen.fault(found, Kind::ColdExtrusion, || format!("never heated: {}", seen.text())),
        }
    }

    fn apply(&mut self, seen: &LineContext<'_>) {
        let Some(code) = seen.line.code else {
            if let Some(name) = seen.named() {
                let labels = name.starts_with(b"EXCLUDE_OBJECT") || name.starts_with(b"SET_");
                self.elsewhere |= !labels || name.starts_with(b"SET_HEATER");
                self.macro_at_end |= !labels;
            }
            return;
        };
        let words = || seen.line.words();
        let target = || words().get(b'S').or_else(|| words().get(b'R'));
        match (code.letter, code.number) {
            (b'T', tool) => {
                let tool = (tool as usize).min(NOZZLES - 1);
                // A tool that was not heated by its number prints with the heater that is in use.
                if self.nozzles[tool].is_none() && self.heaters[tool].is_none() && tool != self.tool {
                    self.heaters[tool] = Some(self.heater(self.tool));
                }
                self.tool = tool;
            }
            (b'M', 104 | 109) => {
                let named = words().get(b'T').map(|tool| (tool as usize).min(NOZZLES - 1));
                if let Some(tool) = named.filter(|tool| *tool != self.tool) {
                    self.heaters[tool] = None;
                }
                let tool = self.heater(named.unwrap_or(self.tool));
                let before = self.nozzles[tool];
                self.nozzles[tool] = target().or(before);
                let cools = target().zip(before).is_some_and(|(to, from)| to < from && to > 0.0);
                self.idle[tool] = code.number == 104
                    && (self.idle[tool] || cools && self.begun && tool != self.heater(self.tool));
                // What has cooled down has to be waited for again; others than the one in use are seen to apart.
                let cools = tool == self.heater(self.tool) && target().is_some_and(|c| c < COLD_C);
                self.awaited = code.number == 109 || self.awaited && !cools;
            }
            (b'M', 116) => (self.awaited, self.idle) = (true, [false; NOZZLES]),
            (b'M', 140 | 190) => self.bed = target().unwrap_or(self.bed),
            (b'M', 302) => {
                self.cold_allowed =
                    words().get(b'S').is_some_and(|s| s < COLD_C) || words().get(b'P') == Some(1.0)
            }
            // RepRapFirmware's and Bambu's commands to heat, macro files, and files that call others.
            (b'G', 10) => self.elsewhere |= words().get(b'S').is_some() || words().get(b'R').is_some(),
            (b'M', 98 | 32 | 568 | 620 | 1002) => (self.elsewhere, self.macro_at_end) = (true, true),
            _ => {}
        }
    }
}
