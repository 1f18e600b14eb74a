//! What is written is checked before anybody gets it.

use std::io;

use crate::check::{Checker, FaultFinder, Found, Kind, Location};
use crate::gcode::each_line;
use crate::job::{CheckError, JobError};
use crate::motion::LayerMoves;
use crate::profile::Settings;
use crate::source::Source;

/// Of so many layers, one is read as it is written, beside the first ones; the others are judged by their moves. Each way keeps the
/// other honest.
const SAMPLED: usize = 8;
const FIRST: usize = 2;

/// Checks a print while it is written.
pub(super) struct Inspector {
    checker: Checker,
    /// Whether layers may be judged by their moves, and the cross-section of the filament.
    by_moves: bool,
    filament_area_mm2: f64,
}

impl Inspector {
    /// An inspector of what comes after a header.
    pub(super) fn new(settings: &Settings, header: &[u8]) -> Self {
        let mut checker = Checker::with(FaultFinder::of_paths(settings, false));
        checker.text(header);
        checker.forget_retraction();
        Self {
            checker,
            by_moves: settings.tool_count() == 1 && !settings.retract.firmware,
            filament_area_mm2: settings.filament.area_mm2(),
        }
    }

    /// Adds whole lines.
    pub(super) fn take(&mut self, text: &[u8]) {
        self.checker.text(text);
    }

    /// Adds a layer, of which the moves may be at hand.
    pub(super) fn layer(&mut self, index: usize, text: &[u8], moves: Option<&LayerMoves>) {
        let sampled = index < FIRST || index.is_multiple_of(SAMPLED);
        let moves = moves.filter(|_| self.by_moves && !sampled);
        if !moves.is_some_and(|moves| self.checker.layer(moves, text, self.filament_area_mm2)) {
            self.take(text);
        }
    }

    /// Whether the print may be let go.
    ///
    /// # Errors
    /// [`JobError::Check`] with the first fault.
    pub(super) fn verdict(self) -> Result<(), JobError> {
        refuse(self.checker.finish().first_of_paths(&Found::default()))
    }
}

/// Checks a rewritten file: it may have no kind of fault that the original has not.
///
/// # Errors
/// [`JobError::Check`] with the first fault, and those of reading.
pub(super) fn remade(source: Source<'_>, found: &Found, settings: &Settings) -> Result<(), JobError> {
    if found.first_of_paths(&Found::default()).is_none() {
        return Ok(());
    }
    let failed = |error: io::Error| source.error(error);
    let mut checker = Checker::with(FaultFinder::of_paths(settings, true));
    each_line(source.open().map_err(failed)?, |line| {
        checker.line(line);
    })
    .map_err(failed)?;
    refuse(found.first_of_paths(&checker.finish()))
}

fn refuse(fault: Option<(Kind, Location)>) -> Result<(), JobError> {
    match fault {
        Some((kind, at)) => Err(CheckError::Fault { kind, at }.into()),
        None => Ok(()),
    }
}
