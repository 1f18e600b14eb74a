//! A finished layer, on its way to be written.

use crate::gcode::LayerText;
use crate::motion::{LayerMoves, Move, ToolSums};
use crate::report::LayerSummary;

use super::kept::PrintLayer;

/// A finished layer.
pub(super) struct FinishedLayer {
    pub text: LayerText,
    pub summary: LayerSummary,
    pub tools: Vec<ToolSums>,
    pub layer: Option<PrintLayer>,
    pub moves: Option<LayerMoves>,
    pub entry: LayerEntry,
    /// Where tools cool down.
    pub timeline: Option<Timeline>,
}

/// Where a layer begins.
pub(super) struct LayerEntry {
    pub index: usize,
    /// Height of the nozzle, Z offset included.
    pub z_mm: f64,
    pub position_mm: [f64; 3],
}

/// When the moves of a layer end, from its beginning on, seconds; and which of them change the tool.
pub(super) struct Timeline {
    pub ends_s: Vec<f64>,
    pub changes: Vec<usize>,
}

impl Timeline {
    /// `times_s`: how long each move takes, without waiting for heat.
    pub fn new(layer: &LayerMoves, times_s: &[f64]) -> Self {
        let mut end_s = 0.0;
        let mut add = |time_s: &f64| {
            end_s += time_s;
            end_s
        };
        let changes = layer.moves.iter().enumerate().filter(|(_, step)| matches!(step, Move::ToolChange(_)));
        Self {
            changes: changes.map(|(index, _)| index).collect(),
            ends_s: times_s.iter().map(&mut add).collect(),
        }
    }
}
