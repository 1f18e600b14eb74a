//! Where G-code comes from.

use std::fmt;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Cursor, Seek};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

/// Size of the buffer in front of a file.
const BUFFER_BYTES: usize = 1 << 18;

/// What G-code is read from.
pub(crate) trait Input: BufRead + Seek + Send {}

impl<T: BufRead + Seek + Send> Input for T {}

/// G-code in a file, or in memory.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Source {
    File(PathBuf),
    Memory(Arc<[u8]>),
}

impl Source {
    /// Begins reading.
    ///
    /// # Errors
    /// As the system says.
    pub fn open(&self) -> io::Result<Box<dyn Input>> {
        Ok(match self {
            Self::File(path) => Box::new(BufReader::with_capacity(BUFFER_BYTES, File::open(path)?)),
            Self::Memory(bytes) => Box::new(Cursor::new(Arc::clone(bytes))),
        })
    }

    /// What tells that it has been changed.
    ///
    /// # Errors
    /// As the system says.
    pub fn stamp(&self) -> io::Result<(u64, Option<SystemTime>)> {
        match self {
            Self::File(path) => std::fs::metadata(path).map(|found| (found.len(), found.modified().ok())),
            Self::Memory(bytes) => Ok((bytes.len() as u64, None)),
        }
    }
}

impl From<&Path> for Source {
    fn from(path: &Path) -> Self {
        Self::File(path.to_owned())
    }
}

impl From<Vec<u8>> for Source {
    fn from(bytes: Vec<u8>) -> Self {
        Self::Memory(bytes.into())
    }
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(path) => path.display().fmt(f),
            Self::Memory(_) => f.write_str("the G-code"),
        }
    }
}
