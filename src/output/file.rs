//! Files, written beside their place and renamed, and streams.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufRead, BufReader, ErrorKind, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use tempfile::NamedTempFile;

use crate::parallel;

/// So much is held in memory, where it can be patched, before it is written.
const HELD_BYTES: usize = 1 << 18;

/// Size of a buffer for reading.
const BUFFER_BYTES: usize = 1 << 18;

/// What names of temporary files begin and end with.
const PREFIX: &str = ".pathwright-";
const SUFFIX: &str = ".tmp";
/// A temporary file that was not touched for so long is abandoned.
const ABANDONED: Duration = Duration::from_secs(24 * 3600);

/// Temporary files of this process that are not complete yet.
static PENDING: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// The destination of a path.
pub(super) enum Opened {
    File(Pending),
    Device(File),
}

/// An output that is written at once.
#[derive(Debug)]
pub(super) enum Stream {
    Stdout,
    Device(File),
}

/// The file that a path stands for, which need not exist: symbolic links followed, also broken ones.
pub fn resolve_links(path: &Path) -> PathBuf {
    const LONGEST_CHAIN: usize = 40;
    let mut path = path.to_owned();
    for _ in 0..LONGEST_CHAIN {
        match fs::read_link(&path) {
            Ok(next) => path = path.parent().unwrap_or(Path::new("")).join(next),
            Err(_) => break,
        }
    }
    path
}

/// A path, to be written.
pub(super) fn open(path: &Path) -> io::Result<Opened> {
    let target = resolve_links(path);
    let existing = match fs::metadata(&target) {
        Ok(existing) => Some(existing),
        Err(error) if error.kind() == ErrorKind::NotFound => None,
        Err(error) => return Err(error),
    };
    if let Some(existing) = &existing {
        if existing.is_dir() {
            return Err(io::Error::new(ErrorKind::IsADirectory, "it is a folder"));
        }
        if !existing.is_file() {
            let device = OpenOptions::new().write(true).open(&target)?;
            return Ok(Opened::Device(device));
        }
        if existing.permissions().readonly() {
            return Err(io::Error::new(ErrorKind::PermissionDenied, "the file is write-protected"));
        }
    }
    let folder = target.parent().unwrap_or(Path::new("")).to_owned();
    let mut pending = Pending::create(&folder, target)?;
    if let Some(existing) = existing {
        pending.replaces = true;
        // Memory cards and network drives may know no modes; that is no reason not to write.
        let _ = pending.file.as_file().set_permissions(existing.permissions());
    }
    Ok(Opened::File(pending))
}

/// Removes temporary files that runs have left behind which were killed outright. Those of a day may still be written.
fn sweep(folder: &Path) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let ours = name.to_str().is_some_and(|name| name.starts_with(PREFIX) && name.ends_with(SUFFIX));
        let old = || entry.metadata().ok()?.modified().ok()?.elapsed().ok().map(|age| age > ABANDONED);
        if ours && old() == Some(true) {
            // Another run may have done it; if it cannot be done, that is no reason not to write.
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// A temporary file, and what it will be renamed to. Removed when dropped, and by [`abandon_and_exit`].
#[derive(Debug)]
pub(super) struct Pending {
    file: NamedTempFile,
    /// How much of the file is written.
    written: u64,
    /// What comes after that.
    held: Vec<u8>,
    target: PathBuf,
    /// Whether there is such a file already.
    replaces: bool,
}

impl Pending {
    pub fn create(folder: &Path, target: PathBuf) -> io::Result<Self> {
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        let mut pending = PENDING.lock().unwrap_or_else(PoisonError::into_inner);
        // Those that were given up have removed themselves.
        pending.retain(|path| path.exists());
        let swept = folder.to_owned();
        parallel::aside(move || sweep(&swept));
        let mut builder = tempfile::Builder::new();
        builder.prefix(PREFIX).suffix(SUFFIX);
        // A temporary file is private unless told otherwise; the process's umask still applies to this.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let file = builder.tempfile_in(folder)?;
        pending.push(file.path().to_owned());
        Ok(Self { file, written: 0, held: Vec::with_capacity(HELD_BYTES), target, replaces: false })
    }

    pub fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        if self.held.len() + bytes.len() > HELD_BYTES {
            self.write_held()?;
        }
        self.held.extend_from_slice(bytes);
        Ok(())
    }

    fn write_held(&mut self) -> io::Result<()> {
        self.file.write_all(&self.held)?;
        if self.replaces {
            begin_writing(self.file.as_file(), self.written, self.held.len() as u64);
        }
        self.written += self.held.len() as u64;
        self.held.clear();
        Ok(())
    }

    /// Replaces bytes that were appended before.
    pub fn patch(&mut self, offset: u64, bytes: &[u8]) -> io::Result<()> {
        if let Some(from) = offset.checked_sub(self.written) {
            self.held[from as usize..][..bytes.len()].copy_from_slice(bytes);
            return Ok(());
        }
        if offset + bytes.len() as u64 > self.written {
            self.write_held()?;
        }
        write_at(self.file.as_file(), offset, bytes)
    }

    /// What has been written, from an offset on.
    pub fn reread(&mut self, offset: u64) -> io::Result<Box<dyn BufRead + Send>> {
        self.write_held()?;
        let mut opened = File::open(self.file.path())?;
        opened.seek(SeekFrom::Start(offset))?;
        Ok(Box::new(BufReader::with_capacity(BUFFER_BYTES, opened)))
    }

    /// Where the file is until it is renamed.
    pub fn folder(&self) -> PathBuf {
        self.file.path().parent().unwrap_or(Path::new(".")).to_owned()
    }

    /// Chooses another name in the same folder. Returns the path.
    pub fn retarget(&mut self, name: &str) -> &Path {
        self.target.set_file_name(name);
        &self.target
    }

    pub fn rename(mut self) -> io::Result<()> {
        self.write_held()?;
        let file = self.file;
        let mut pending = PENDING.lock().unwrap_or_else(PoisonError::into_inner);
        let temporary = file.path().to_owned();
        let renamed = file.persist(&self.target).map(drop).map_err(|error| error.error);
        pending.retain(|path| *path != temporary);
        renamed
    }
}

/// Has the system begin to write to the disk what it would wait for when the file replaces another (ext4).
#[cfg(all(feature = "system", target_os = "linux"))]
fn begin_writing(file: &File, from: u64, bytes: u64) {
    use nix::fcntl::{PosixFadviseAdvice, posix_fadvise};
    // Without it, replacing takes longer, no more.
    let _ = posix_fadvise(file, from as i64, bytes as i64, PosixFadviseAdvice::POSIX_FADV_DONTNEED);
}

/// Elsewhere the system sees to it.
#[cfg(not(all(feature = "system", target_os = "linux")))]
fn begin_writing(_: &File, _: u64, _: u64) {}

/// Writes at an offset; what is appended goes on where it would have.
#[cfg(unix)]
fn write_at(file: &File, offset: u64, bytes: &[u8]) -> io::Result<()> {
    std::os::unix::fs::FileExt::write_all_at(file, bytes, offset)
}

/// Writes at an offset; what is appended goes on where it would have.
#[cfg(not(unix))]
fn write_at(mut file: &File, offset: u64, bytes: &[u8]) -> io::Result<()> {
    file.seek(SeekFrom::Start(offset))?;
    file.write_all(bytes)?;
    file.seek(SeekFrom::End(0)).map(drop)
}

/// Removes incomplete output and ends the process, for a signal; from any thread. What has been renamed stays.
pub fn abandon_and_exit(code: i32) -> ! {
    // Kept locked until the end, so that no file is begun or renamed meanwhile.
    let pending = PENDING.lock().unwrap_or_else(PoisonError::into_inner);
    for path in pending.iter() {
        // A file that is gone already is as good; no message is possible.
        let _ = fs::remove_file(path);
    }
    std::process::exit(code)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patches_reach_what_is_written_what_is_held_and_what_is_both() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("file");
        let mut pending = Pending::create(folder.path(), target.clone()).unwrap();
        let mut wanted = Vec::new();
        for part in (0..5).map(|byte| vec![byte; 75_000]) {
            pending.append(&part).unwrap();
            wanted.extend(part);
        }
        assert_eq!((pending.written, pending.held.len()), (225_000, 150_000));
        for offset in [374_990, 0, 112_500, 225_000, 224_995, 300_000] {
            pending.patch(offset, &[9; 10]).unwrap();
            wanted[offset as usize..][..10].fill(9);
        }
        pending.rename().unwrap();
        assert!(fs::read(&target).unwrap() == wanted);
    }
}
