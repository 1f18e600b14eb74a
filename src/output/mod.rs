//! Where G-code goes: whole, or not at all.
//!
//! A file is written under another name in the same folder and renamed when it is complete, so that a
//! printer that watches the folder never sees half a job. A device, a pipe or standard output cannot be renamed or
//! patched: what goes there is held back and written in one go, so that its bytes are those of the file.

#[cfg(feature = "cli")]
mod file;

use std::io::{self, BufRead, ErrorKind};

#[cfg(feature = "cli")]
pub use file::{abandon_and_exit, resolve_links};

/// What could not be done to which output.
#[derive(Debug, thiserror::Error)]
#[error("{path}: {}", reason(source))]
pub struct OutputError {
    /// As the user named it.
    pub path: String,
    /// What the system says.
    pub source: io::Error,
}

impl OutputError {
    /// The reader of a pipe went away; nobody is interested in a message.
    pub fn is_broken_pipe(&self) -> bool {
        self.source.kind() == ErrorKind::BrokenPipe
    }
}

fn reason(error: &io::Error) -> String {
    match error.kind() {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => "the disk is full; free some space".into(),
        ErrorKind::NotFound => "cannot be written: there is no such folder".into(),
        ErrorKind::PermissionDenied => format!("cannot be written: {error}; choose another place with -o"),
        _ => format!("cannot be written: {error}"),
    }
}

/// A destination that is being written. Dropped without [`Output::commit`], it leaves nothing behind.
#[derive(Debug)]
pub struct Output {
    name: String,
    written: u64,
    sink: Sink,
}

#[derive(Debug)]
enum Sink {
    #[cfg(feature = "cli")]
    File(file::Pending),
    Memory(Vec<u8>),
    /// Held back for what cannot be patched.
    #[cfg(feature = "cli")]
    Direct(Vec<u8>, file::Stream),
}

impl Output {
    /// Nowhere: the bytes are for [`Output::into_bytes`].
    pub fn memory() -> Self {
        Self { name: "memory".into(), written: 0, sink: Sink::Memory(Vec::new()) }
    }

    /// What was written, where it is held in memory; nothing of a file.
    pub fn into_bytes(self) -> Vec<u8> {
        match self.sink {
            Sink::Memory(held) => held,
            #[cfg(feature = "cli")]
            Sink::Direct(held, _) => held,
            #[cfg(feature = "cli")]
            Sink::File(_) => Vec::new(),
        }
    }

    /// Appends.
    ///
    /// # Errors
    /// As the system says, for example that the disk is full.
    pub fn write(&mut self, bytes: &[u8]) -> Result<(), OutputError> {
        self.written += bytes.len() as u64;
        match &mut self.sink {
            Sink::Memory(held) => held.extend_from_slice(bytes),
            #[cfg(feature = "cli")]
            Sink::Direct(held, _) => held.extend_from_slice(bytes),
            #[cfg(feature = "cli")]
            Sink::File(file) => file.append(bytes).map_err(|source| self.error(source))?,
        }
        Ok(())
    }

    /// Bytes written so far: where the next ones go.
    pub fn written(&self) -> u64 {
        self.written
    }

    /// Replaces bytes that were written before.
    ///
    /// # Errors
    /// As [`Output::write`], and if the place has not been written yet.
    pub fn patch(&mut self, offset: u64, bytes: &[u8]) -> Result<(), OutputError> {
        if offset.checked_add(bytes.len() as u64).is_none_or(|end| end > self.written) {
            return Err(self.error(io::Error::new(ErrorKind::InvalidInput, "patch beyond the end")));
        }
        let range = offset as usize..offset as usize + bytes.len();
        match &mut self.sink {
            Sink::Memory(held) => held[range].copy_from_slice(bytes),
            #[cfg(feature = "cli")]
            Sink::Direct(held, _) => held[range].copy_from_slice(bytes),
            #[cfg(feature = "cli")]
            Sink::File(file) => file.patch(offset, bytes).map_err(|source| self.error(source))?,
        }
        Ok(())
    }

    /// What has been written so far, from an offset on.
    ///
    /// # Errors
    /// As [`Output::write`].
    pub fn reread(&mut self, offset: u64) -> Result<Box<dyn BufRead + Send + '_>, OutputError> {
        let from = |held: &'_ [u8]| held.len().min(offset as usize);
        match &mut self.sink {
            Sink::Memory(held) => Ok(Box::new(&held[from(held)..])),
            #[cfg(feature = "cli")]
            Sink::Direct(held, _) => Ok(Box::new(&held[from(held)..])),
            #[cfg(feature = "cli")]
            Sink::File(file) => match file.reread(offset) {
                Ok(text) => Ok(text),
                Err(source) => Err(OutputError { path: self.name.clone(), source }),
            },
        }
    }

    fn error(&self, source: io::Error) -> OutputError {
        OutputError { path: self.name.clone(), source }
    }
}
