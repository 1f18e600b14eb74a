//! What came of a revision.

use std::sync::Arc;

use crate::gcode::{BinaryMetadata, write_binary};
use crate::report::Summary;

/// What came of a revision so far.
#[derive(Clone, Debug, Default)]
pub struct Results {
    /// The revision.
    pub revision: u64,
    /// The walls of all layers, packed; see [`preview`](crate::view::preview).
    pub walls: Option<Arc<[u8]>>,
    /// The print, packed likewise.
    pub preview: Option<Arc<[u8]>>,
    /// What the file should be called.
    pub name: String,
    pub(super) gcode: Option<Arc<[u8]>>,
    /// With it the file is binary.
    pub(super) binary: Option<Arc<BinaryMetadata>>,
    /// What the slicing came to, with all layers.
    pub summary: Option<Arc<Summary>>,
}

impl Results {
    /// The file, text or binary as the settings say.
    pub fn file(&self) -> Option<Arc<[u8]>> {
        let gcode = self.gcode.as_ref()?;
        let Some(metadata) = &self.binary else { return Some(gcode.clone()) };
        let mut file = Vec::new();
        // Memory takes what is written.
        write_binary(gcode, metadata, &mut file).ok()?;
        Some(file.into())
    }

    /// The G-code as text.
    pub fn gcode(&self) -> Option<Arc<[u8]>> {
        self.gcode.clone()
    }

    /// Whether the print is complete.
    pub fn is_complete(&self) -> bool {
        self.gcode.is_some()
    }

    /// About how many bytes it holds.
    pub(super) fn bytes(&self) -> usize {
        let length = |bytes: &Option<Arc<[u8]>>| bytes.as_ref().map_or(0, |bytes| bytes.len());
        let layers = self.summary.as_ref().map_or(0, |summary| 128 * summary.layers.len());
        length(&self.walls) + length(&self.preview) + length(&self.gcode) + layers
    }
}
