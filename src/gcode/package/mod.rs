//! Packages with G-code (`.gcode.3mf`), as Bambu Studio and OrcaSlicer write them for Bambu Lab's printers: a ZIP of the parts of a
//! 3MF, with the G-code of a plate, its MD5 sum, and what the printer shows of it.
//!
//! They are read, and written again with other G-code. New ones are not made: printers check more of what is in them than is known.

mod read;
#[cfg(feature = "cli")]
mod write;

pub(super) use read::{MAGIC, open};
#[cfg(feature = "cli")]
pub(crate) use write::{Parts, write};
