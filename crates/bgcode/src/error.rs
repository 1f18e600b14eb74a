//! What can be wrong with a file.

use std::fmt;
use std::io;

use crate::format::BlockKind;

/// Why binary G-code cannot be read or written.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The system refused to read or to write.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The file is no binary G-code, is damaged, or uses what is not known here.
    #[error("{place}: {reason}")]
    Damaged {
        /// Where.
        place: Place,
        /// What is wrong, and what helps.
        reason: String,
    },
}

/// A place in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// Number of the block, from 1; 0 for the file's header.
    pub block: u64,
    /// What the block is, as far as it was read.
    pub kind: Option<BlockKind>,
    /// Bytes from the start of the file to the start of the block.
    pub offset: u64,
}

impl Place {
    /// The error that something is wrong here.
    pub(crate) fn damaged(self, reason: impl Into<String>) -> Error {
        Error::Damaged { place: self, reason: reason.into() }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.block, self.kind) {
            (0, _) => write!(f, "the header of the binary G-code"),
            (block, Some(kind)) => write!(f, "block {block} ({}) at byte {}", kind.name(), self.offset),
            (block, None) => write!(f, "block {block} at byte {}", self.offset),
        }
    }
}

impl From<Error> for io::Error {
    fn from(error: Error) -> Self {
        match error {
            Error::Io(error) => error,
            damaged => Self::new(io::ErrorKind::InvalidData, damaged),
        }
    }
}
