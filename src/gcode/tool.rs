//! Changes of tool as text.

use std::ops::Range;

use super::flavor::line;
use super::number::text;
use super::settings::WriterSettings;
use crate::motion::ToolChange;
use crate::toolpath::ToolId;
use crate::units::Celsius;

/// A change of tool in a layer's text.
#[derive(Clone, Debug, PartialEq)]
pub struct ToolMark {
    /// The line that lets the tool before cool down; empty where it stays hot.
    pub idle: Range<usize>,
    /// The line that takes the tool, which a script may do itself.
    pub line: Range<usize>,
    /// The change.
    pub change: ToolChange,
}

/// Heats a tool whose turn comes, without waiting.
pub(crate) fn preheating(tool: ToolId, nozzle: Celsius) -> String {
    format!("M104 T{tool} S{}\n", text(nozzle.0, 1))
}

/// Writes a change: the tool before cools down, the next one is taken, heated, and waited for. Returns where its lines are.
///
/// A heater that both share is waited for after the change, where the temperature differs; a tool's own heater wherever the
/// tool may have cooled down.
pub(super) fn change(out: &mut Vec<u8>, change: &ToolChange, settings: &WriterSettings) -> ToolMark {
    let tool = |tool: u8| settings.tools.get(usize::from(tool));
    let ToolChange { from, to, before, nozzle, .. } = *change;
    let idle = |id: u8| tool(id).map(|tool| tool.idle.0).filter(|idle| *idle > 0.0);
    let begin = out.len();
    if let Some(idle) = idle(from) {
        line(out, &format!("M104 T{from} S{}", text(idle, 1)));
    }
    let first = out.len();
    line(out, &format!("T{to}"));
    let end = out.len();
    let own = tool(to).is_some_and(|tool| tool.has_heater);
    if own && nozzle.0 > 0.0 {
        // It may be at the temperature of another layer.
        let command = if idle(to).is_some() { "M109" } else { "M104" };
        line(out, &format!("{command} T{to} S{}", text(nozzle.0, 1)));
    } else if nozzle.0 > 0.0 && nozzle != before {
        line(out, &format!("M109 S{}", text(nozzle.0, 1)));
    }
    ToolMark { idle: begin..first, line: first..end, change: *change }
}
