//! What is no line of G-code.

use std::io::{self, ErrorKind};

/// Longer lines are no G-code.
pub(super) const LONGEST_LINE: usize = 1 << 22;

/// A line, by its number, holds what no text holds.
pub(super) fn binary(number: usize) -> io::Error {
    io::Error::new(ErrorKind::InvalidData, format!("line {number}: binary data; this is no G-code text"))
}

/// A line is longer than [`LONGEST_LINE`].
pub(super) fn too_long() -> io::Error {
    io::Error::new(ErrorKind::InvalidData, "a line is longer than 4 MB; this is no G-code text")
}
