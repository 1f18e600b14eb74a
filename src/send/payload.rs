//! The file that is sent, with its sums.

use std::fmt;
use std::fs::File;
use std::io::{self, Cursor, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use sha1::Sha1;
use sha2::{Digest, Sha256};

use crate::gcode::{Form, Input};
use crate::job::hexadecimal;
use crate::source::Source;

/// Read at once.
const BLOCK_BYTES: usize = 1 << 16;

/// Where it is.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Place {
    File(PathBuf),
    Memory(Arc<[u8]>),
}

/// A file that is sent, with its sums.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Payload {
    place: Place,
    /// Its size.
    pub bytes: u64,
    /// SHA-256 in hexadecimal digits, which Moonraker compares.
    pub sha256: String,
    /// SHA-1 in hexadecimal digits, which OctoPrint tells.
    pub sha1: String,
    /// CRC-32 (IEEE), which RepRapFirmware compares.
    pub crc32: u32,
}

impl Payload {
    /// Reads a file once for its sums.
    ///
    /// # Errors
    /// As the system says.
    pub fn of(path: &Path) -> io::Result<Self> {
        Self::read(Place::File(path.to_owned()))
    }

    /// A file in memory.
    ///
    /// # Errors
    /// None in fact.
    pub fn of_bytes(bytes: impl Into<Arc<[u8]>>) -> io::Result<Self> {
        Self::read(Place::Memory(bytes.into()))
    }

    fn read(place: Place) -> io::Result<Self> {
        let mut file = place.open()?;
        let (mut sha256, mut sha1, mut crc32) = (Sha256::new(), Sha1::new(), crc32fast::Hasher::new());
        let (mut bytes, mut block) = (0, vec![0; BLOCK_BYTES]);
        loop {
            let read = match file.read(&mut block) {
                Ok(0) => break,
                Ok(read) => &block[..read],
                Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                Err(error) => return Err(error),
            };
            bytes += read.len() as u64;
            sha256.update(read);
            sha1.update(read);
            crc32.update(read);
        }
        drop(file);
        Ok(Self {
            place,
            bytes,
            sha256: hexadecimal(&sha256.finalize()),
            sha1: hexadecimal(&sha1.finalize()),
            crc32: crc32.finalize(),
        })
    }

    /// Its bytes again, from the beginning.
    pub(super) fn raw(&self) -> io::Result<Box<dyn Read + '_>> {
        self.place.open()
    }

    /// The same, counted.
    pub(super) fn open<'a>(&'a self, told: &'a mut dyn FnMut(u64)) -> io::Result<Counted<'a>> {
        Ok(Counted { file: self.raw()?, left: self.bytes, done: 0, told })
    }

    /// Its text, also where it is binary G-code or a package.
    pub(super) fn text(&self) -> io::Result<Box<dyn Input + '_>> {
        self.source().open()
    }

    /// How it holds G-code.
    pub(super) fn form(&self) -> Form {
        self.source().form()
    }

    fn source(&self) -> Source<'_> {
        match &self.place {
            Place::File(path) => Source::File(path),
            Place::Memory(bytes) => Source::Memory(bytes),
        }
    }
}

impl fmt::Display for Payload {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.source().fmt(f)
    }
}

impl Place {
    fn open(&self) -> io::Result<Box<dyn Read + '_>> {
        Ok(match self {
            Self::File(path) => Box::new(File::open(path)?),
            Self::Memory(bytes) => Box::new(Cursor::new(&**bytes)),
        })
    }
}

/// As many bytes of a file as it had, told while they are read.
pub(super) struct Counted<'a> {
    file: Box<dyn Read + 'a>,
    left: u64,
    done: u64,
    told: &'a mut dyn FnMut(u64),
}

impl Read for Counted<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let most = usize::try_from(self.left).unwrap_or(usize::MAX).min(buffer.len());
        let read = self.file.read(&mut buffer[..most])?;
        if read == 0 && most > 0 {
            return Err(io::Error::other("the file became shorter while it was sent"));
        }
        self.left -= read as u64;
        self.done += read as u64;
        (self.told)(self.done);
        Ok(read)
    }
}

#[cfg(all(test, feature = "cli"))]
mod tests {
    use super::*;

    #[test]
    fn sums_are_those_of_the_standards() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        std::fs::write(&path, "123456789").unwrap();
        let payload = Payload::of(&path).unwrap();
        assert_eq!(payload.bytes, 9);
        assert_eq!(payload.crc32, 0xcbf4_3926);
        assert_eq!(payload.sha1, "f7c3bc1d808e04732adf679965ccc34ca7ae3441");
        assert_eq!(payload.sha256, "15e2b0d3c33891ebb0f1ef609ec419420c20e320ce94c65fbc8c3312448eb225");
    }

    #[test]
    fn a_file_that_shrinks_is_no_shorter_upload() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        std::fs::write(&path, "123456789").unwrap();
        let payload = Payload::of(&path).unwrap();
        std::fs::write(&path, "1234").unwrap();
        let read = payload.open(&mut |_| {}).unwrap().read_to_end(&mut Vec::new());
        assert!(read.unwrap_err().to_string().contains("shorter"));
        std::fs::write(&path, "1234567890123").unwrap();
        let (mut last, mut all) = (0, Vec::new());
        payload.open(&mut |done| last = done).unwrap().read_to_end(&mut all).unwrap();
        assert_eq!((last, all.len()), (9, 9));
    }
}
