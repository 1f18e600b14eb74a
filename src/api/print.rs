//! What a plate becomes.

use std::io::{self, Write};

use crate::gcode::{BinaryMetadata, write_binary};
use crate::pipeline::PrintLayer;
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
