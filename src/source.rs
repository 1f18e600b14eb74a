//! Where G-code comes from.

use std::fmt;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Cursor, Seek};
use std::path::Path;
use std::time::SystemTime;

use crate::job::{InputError, JobError};

/// Size of the buffer in front of a file.
const BUFFER_BYTES: usize = 1 << 18;

/// What G-code is read from.
pub(crate) trait Input: BufRead + Seek + Send {}

impl<T: BufRead + Seek + Send> Input for T {}

/// G-code in a file, or in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Source<'a> {
    File(&'a Path),
    Memory(&'a [u8]),
}

impl<'a> Source<'a> {
    /// Begins reading.
    ///
    /// # Errors
    /// As the system says.
    pub fn open(self) -> io::Result<Box<dyn Input + 'a>> {
        Ok(match self {
            Self::File(path) => Box::new(BufReader::with_capacity(BUFFER_BYTES, File::open(path)?)),
            Self::Memory(bytes) => Box::new(Cursor::new(bytes)),
        })
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
