//! What a plate becomes.

use std::io::{self, Write};

use crate::gcode::{BinaryMetadata, write_binary};
use crate::job::{Job, JobError};
use crate::observer::Observer;
use crate::output::Output;
use crate::pipeline::{Pipeline, PrintLayer};
use crate::profile::{Settings, binary_metadata};
use crate::report::Summary;

/// A sliced plate.
#[derive(Clone, Debug)]
pub struct Print {
    pub(super) gcode: Vec<u8>,
    pub(super) metadata: BinaryMetadata,
    pub(super) summary: Summary,
    pub(super) layers: Vec<PrintLayer>,
}

impl Print {
    /// Slices a job, models and all, as the program does.
    ///
    /// # Errors
    /// Those of [`Slicer::slice`](super::Slicer::slice); a model that cannot be read.
    pub fn of(job: &Job, settings: &Settings, observer: &Observer<'_>) -> Result<Self, JobError> {
        let (mut output, mut layers) = (Output::memory(), Vec::new());
        let summary = Pipeline::slice_job(job, settings, &mut output, &mut layers, observer)?;
        Ok(Self { gcode: output.into_bytes(), metadata: binary_metadata(settings), summary, layers })
    }

    /// The G-code, the summary and the layers, without copies.
    pub fn into_parts(self) -> (Vec<u8>, Summary, Vec<PrintLayer>) {
        (self.gcode, self.summary, self.layers)
    }

    /// Writes the G-code.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write_gcode(&self, to: &mut impl Write) -> io::Result<()> {
        to.write_all(&self.gcode)
    }

    /// Writes the G-code as binary G-code (`.bgcode`), with the settings that it was made with.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write_binary_gcode(&self, to: &mut impl Write) -> io::Result<()> {
        write_binary(&self.gcode, &self.metadata, to)
    }

    /// The G-code.
    pub fn gcode(&self) -> &[u8] {
        &self.gcode
    }

    /// Size, time, filament, travel, repairs, warnings; `Display` gives text, `Serialize` JSON.
    pub fn summary(&self) -> &Summary {
        &self.summary
    }

    /// The layers from the bed up: paths with role and width, moves with times.
    pub fn layers(&self) -> &[PrintLayer] {
        &self.layers
    }
}
