//! Filament: retracted and unretracted in pairs, extruded only along beads, no faster than it melts.

use super::fault::Kind;
use super::report::Found;
use super::rule::{LineContext, Rule};
use crate::gcode::{Action, Stroke};
use crate::profile::Settings;
use crate::toolpath::Role;

/// Amounts of filament below this are rounding.
const SLACK_MM: f64 = 1e-3;
/// A bead on which amounts and lengths are rounded says little about the flow.
const SHORTEST_MM: f64 = 0.2;

/// No hot end is known more exactly than this. Rounding, and beads that widen, take up to a percent.
const FLOW_SLACK: f64 = 1.05;

/// Checks retraction and flow.
pub(super) struct Filament {
    /// What holds for the tool in use, and for each, where the settings list several.
    tool: Tool,
    tools: Vec<Tool>,
    /// Factors of speed and flow in force.
    speed: f64,
    flow: f64,
    /// Whether the filament or the tool has been changed since the last bead: purging in place is in order.
    purging: bool,
    /// Whether G10 or G11 has been seen.
    firmware: bool,
    /// Whether the last move was a bead.
    drawing: bool,
}

/// What holds for a tool.
#[derive(Clone, Copy)]
struct Tool {
    /// Extra filament unretracted on purpose; negative: less.
    extra_mm: f64,
    area_mm2: f64,
    /// Flow that the hot end melts, mm³/s; infinite where it is not known.
    max_flow: f64,
    /// The most that shapes the tip of a filament before it is taken out, into the tower, mm³/s.
    ramming: f64,
}

impl Tool {
    fn new(settings: &Settings) -> Self {
        let max_flow = settings.filament.max_flow.0;
        Self {
            extra_mm: settings.retract.extra.0,
            area_mm2: settings.filament.area_mm2(),
            max_flow: if max_flow > 0.0 { max_flow } else { f64::INFINITY },
            ramming: settings.swap.ramming.iter().copied().fold(0.0, f64::max),
        }
    }
}

impl Filament {
    pub fn new(settings: &Settings) -> Self {
        Self {
            tool: Tool::new(settings),
            tools: (0..settings.tools.len()).map(|tool| Tool::new(&settings.of_tool(tool))).collect(),
            speed: 1.0,
            flow: 1.0,
            purging: false,
            firmware: false,
            drawing: false,
        }
    }

    fn stroke(&mut self, stroke: &Stroke, seen: &LineContext<'_>, found: &mut Found) {
        if seen.in_script {
            // It loads and purges as its printer's vendor has found to be right.
            self.purging &= !stroke.extrudes();
        } else if stroke.extrudes() {
            self.purging = false;
            let back_mm = seen.retracted_mm;
            if seen.firmware_retracted || seen.is_retracted && back_mm > SLACK_MM {
                let how = if seen.firmware_retracted { "by G10".into() } else { format!("{back_mm:.3} mm") };
                seen.fault(found, Kind::RetractedExtrusion, || format!("pulled back {how}: {}", seen.text()));
            } else if back_mm > SLACK_MM - self.tool.extra_mm.min(0.0) && !self.drawing {
                let short = || format!("{back_mm:.3} mm less than was pulled back: {}", seen.text());
                seen.fault(found, Kind::UnbalancedRetraction, short);
            }
            self.flow(stroke, seen, found);
        } else if stroke.fresh_mm > SLACK_MM + self.tool.extra_mm.max(0.0) && seen.begun && !self.purging {
            let fresh_mm = stroke.fresh_mm;
            let (kind, beyond) = match seen.retracted_mm > SLACK_MM {
                true => (Kind::UnbalancedRetraction, " beyond what was pulled back"),
                false => (Kind::ExtrusionInPlace, ""),
            };
            seen.fault(found, kind, || format!("{fresh_mm:.4} mm{beyond}: {}", seen.text()));
        }
        self.drawing = stroke.extrudes();
    }

    fn flow(&mut self, bead: &Stroke, seen: &LineContext<'_>, found: &mut Found) {
        let speed = bead.feed_mm_s * self.speed;
        let Tool { area_mm2, mut max_flow, ramming, .. } = self.tool;
        // Towers are no part of the object, and read as such.
        if matches!(seen.context.role, None | Some(Role::PrimeTower)) {
            max_flow = max_flow.max(ramming);
        }
        if max_flow.is_infinite() || bead.xy_mm < SHORTEST_MM || speed <= 0.0 {
            return;
        }
        let flow = bead.fresh_mm3(area_mm2) * self.flow * speed / bead.xy_mm;
        if flow > max_flow * FLOW_SLACK {
            seen.fault(found, Kind::Flow, || format!("{flow:.1} mm³/s; {max_flow} are melted"));
        }
    }
}

impl Rule for Filament {
    fn check_line(&mut self, seen: &LineContext<'_>, found: &mut Found) {
        match seen.action {
            Action::Stroke(stroke) => self.stroke(stroke, seen, found),
            Action::FirmwareRetract => {
                if seen.firmware_retracted {
                    seen.fault(found, Kind::UnbalancedRetraction, || "G10 twice, without G11 between".into());
                }
                self.firmware = true;
            }
            Action::FirmwareUnretract => {
                // The first may be there to be safe.
                if !seen.firmware_retracted && self.firmware {
                    seen.fault(found, Kind::UnbalancedRetraction, || "G11 without G10 before".into());
                }
                self.firmware = true;
            }
            _ => {
                let Some(code) = seen.line.code else {
                    self.purging |= seen.named().is_some();
                    return;
                };
                let factor = || seen.line.words().get(b'S').filter(|s| *s > 0.0).map_or(1.0, |s| s / 100.0);
                if code.letter == b'T' {
                    self.tool = self.tools.get(code.number as usize).copied().unwrap_or(self.tool);
                }
                match (code.letter, code.number) {
                    (b'M', 220) => self.speed = factor(),
                    (b'M', 221) => self.flow = factor(),
                    (b'T', _) | (b'M', 0 | 1 | 25 | 226 | 600..=603 | 701 | 702) => self.purging = true,
                    _ => {}
                }
            }
        }
    }
}
