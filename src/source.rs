//! Where G-code comes from.

use std::fmt;
use std::io;
use std::path::Path;
use std::time::SystemTime;

use crate::gcode::{self, Input};
use crate::job::{InputError, JobError};

/// G-code in a file, or in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Source<'a> {
    File(&'a Path),
    Memory(&'a [u8]),
}

impl<'a> Source<'a> {
    /// Begins reading, as text whatever it is.
    ///
    /// # Errors
    /// As the system says; or binary G-code is damaged.
    pub fn open(self) -> io::Result<Box<dyn Input + 'a>> {
        match self {
            Self::File(path) => Ok(gcode::open(path)?),
            Self::Memory(bytes) => gcode::open_bytes(bytes),
        }
    }

    /// How it holds G-code.
    #[cfg(feature = "hosts")]
    pub fn form(self) -> gcode::Form {
        match self {
            Self::File(path) => gcode::Form::of_file(path),
            Self::Memory(bytes) => gcode::Form::of_bytes(bytes),
        }
    }

    /// The error of input that cannot be read.
    pub fn error(self, source: io::Error) -> JobError {
        InputError::Read { file: self.to_string(), source }.into()
    }

    /// A stamp that changes with the file.
    ///
    /// # Errors
    /// As the system says.
    pub fn stamp(self) -> io::Result<(u64, Option<SystemTime>)> {
        match self {
            Self::File(path) => std::fs::metadata(path).map(|found| (found.len(), found.modified().ok())),
            Self::Memory(bytes) => Ok((bytes.len() as u64, None)),
        }
    }
}

impl fmt::Display for Source<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(path) => path.display().fmt(f),
            Self::Memory(_) => f.write_str("the G-code"),
        }
    }
}
