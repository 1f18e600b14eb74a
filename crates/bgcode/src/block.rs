//! Blocks, as what they mean.

use crate::format::{BlockKind, ImageFormat};

/// Keys with their values, in the order of the file.
pub type Pairs = Vec<(String, String)>;

/// What the slicer was set to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SlicerMetadata {
    /// Its settings by their keys.
    Pairs(Pairs),
    /// A JSON document, as some writers add it.
    Json(String),
}

/// A picture of the print.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Thumbnail {
    /// Its format.
    pub format: ImageFormat,
    /// Width in pixels.
    pub width: u16,
    /// Height in pixels.
    pub height: u16,
    /// The file of that format.
    pub data: Vec<u8>,
}

/// All that comes before the G-code.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Head {
    /// Who wrote the file: `Producer`, `Produced on`. Left out where empty.
    pub file: Pairs,
    /// What the printer shows and checks: `printer_model`, `filament_type`, …
    pub printer: Pairs,
    /// Pictures.
    pub thumbnails: Vec<Thumbnail>,
    /// Times and amounts.
    pub print: Pairs,
    /// What the slicer was set to.
    pub slicer: Vec<SlicerMetadata>,
}

/// A block that was read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Block {
    /// Who wrote the file.
    FileMetadata(Pairs),
    /// What the printer shows and checks before it prints.
    PrinterMetadata(Pairs),
    /// A picture.
    Thumbnail(Thumbnail),
    /// Times and amounts.
    PrintMetadata(Pairs),
    /// What the slicer was set to.
    SlicerMetadata(SlicerMetadata),
    /// Whole lines of G-code.
    Gcode(Vec<u8>),
}

impl Block {
    /// What kind of block it is.
    pub fn kind(&self) -> BlockKind {
        match self {
            Self::FileMetadata(_) => BlockKind::FileMetadata,
            Self::PrinterMetadata(_) => BlockKind::PrinterMetadata,
            Self::Thumbnail(_) => BlockKind::Thumbnail,
            Self::PrintMetadata(_) => BlockKind::PrintMetadata,
            Self::SlicerMetadata(_) => BlockKind::SlicerMetadata,
            Self::Gcode(_) => BlockKind::Gcode,
        }
    }
}
