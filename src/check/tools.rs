//! Tools: there, and changed with their filament pulled back.

use super::fault::Kind;
use super::report::Found;
use super::rule::{LineContext, Rule};
use crate::gcode::NO_TOOL;
use crate::profile::Settings;

/// Filament pulled back by less is none.
const SLACK_MM: f64 = 1e-3;

/// Checks changes of tool.
pub(super) struct Tools {
    /// How many there are; 0: the settings list none.
    count: u32,
    /// Whether filament is retracted at all.
    retracts: bool,
    tool: Option<u32>,
}

impl Tools {
    pub fn new(settings: &Settings) -> Self {
        let retracts = settings.retract.length.0 > 0.0;
        Self { count: settings.tools.len() as u32, retracts, tool: None }
    }
}

impl Rule for Tools {
    fn check_line(&mut self, seen: &LineContext<'_>, found: &mut Found) {
        let Some(code) = seen.line.code.filter(|code| code.letter == b'T' && code.number < NO_TOOL) else {
            return;
        };
        let before = self.tool.replace(code.number);
        if self.count > 0 && code.number >= self.count {
            let count = self.count;
            seen.fault(found, Kind::UnknownTool, || {
                format!("{}: there are {count}, from T0 on", seen.text())
            });
        }
        let changes = before.is_some_and(|before| before != code.number);
        let back = seen.retracted_mm > SLACK_MM || seen.firmware_retracted;
        if changes && self.retracts && seen.begun && !seen.in_script && !back {
            seen.fault(found, Kind::UnretractedChange, || seen.text());
        }
    }
}
