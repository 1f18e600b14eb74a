//! Files, written beside their place and renamed, and streams.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufRead, BufReader, BufWriter, ErrorKind, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use tempfile::NamedTempFile;

use super::{Output, OutputError, Sink};

/// Size of buffers for files.
const BUFFER_BYTES: usize = 1 << 18;

/// What names of temporary files begin and end with.
const PREFIX: &str = ".pathwright-";
const SUFFIX: &str = ".tmp";
/// A temporary file that was not touched for so long belongs to nobody.
const ABANDONED: Duration = Duration::from_secs(24 * 3600);

/// Temporary files of this process that are not complete yet.
static PENDING: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// What is written in one go.
#[derive(Debug)]
pub(super) enum Stream {
    Stdout,
    Device(File),
}

impl Output {
    /// Standard output.
    pub fn stdout() -> Self {
        let sink = Sink::Direct(Vec::new(), Stream::Stdout);
        Self { name: "standard output".into(), written: 0, sink }
    }

    /// No place at all: what is written can be read back, and is gone then.
    ///
    /// # Errors
    /// If the system has no place for temporary files.
    pub fn nowhere() -> Result<Self, OutputError> {
        let name = "a temporary file".to_owned();
        match Pending::create(&std::env::temp_dir(), PathBuf::new()) {
            Ok(pending) => Ok(Self { name, written: 0, sink: Sink::File(pending) }),
            Err(source) => Err(OutputError { path: name, source }),
        }
    }

    /// A file, by way of a temporary one beside it, which gets the mode of the file that it will replace. What a
    /// symbolic link points to is replaced, not the link. Something that is no regular file is written directly.
    ///
    /// # Errors
    /// If it is a folder or write-protected, or the folder does not exist or cannot be written.
    pub fn create(path: &Path) -> Result<Self, OutputError> {
        let name = path.display().to_string();
        match open(path) {
            Ok(sink) => Ok(Self { name, written: 0, sink }),
            Err(source) => Err(OutputError { path: name, source }),
        }
    }

    /// Puts the complete output in its place.
    ///
    /// # Errors
    /// As [`Output::write`]; then the place is as it was before.
    pub fn commit(self) -> Result<(), OutputError> {
        let done = match self.sink {
            Sink::Memory(_) => Ok(()),
            Sink::File(file) => file.rename(),
            Sink::Direct(held, Stream::Stdout) => {
                let mut stdout = io::stdout().lock();
                stdout.write_all(&held).and_then(|()| stdout.flush())
            }
            Sink::Direct(held, Stream::Device(mut device)) => device.write_all(&held),
        };
        done.map_err(|source| OutputError { path: self.name, source })
    }
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

fn open(path: &Path) -> io::Result<Sink> {
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
            return Ok(Sink::Direct(Vec::new(), Stream::Device(device)));
        }
        if existing.permissions().readonly() {
            return Err(io::Error::new(ErrorKind::PermissionDenied, "the file is write-protected"));
        }
    }
    let folder = target.parent().unwrap_or(Path::new("")).to_owned();
    let pending = Pending::create(&folder, target)?;
    if let Some(existing) = existing {
        // Memory cards and network drives may know no modes; that is no reason not to write.
        let _ = pending.file.get_ref().as_file().set_permissions(existing.permissions());
    }
    Ok(Sink::File(pending))
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
    file: BufWriter<NamedTempFile>,
    target: PathBuf,
}

impl Pending {
    fn create(folder: &Path, target: PathBuf) -> io::Result<Self> {
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        let mut pending = PENDING.lock().unwrap_or_else(PoisonError::into_inner);
        // Those that were given up have removed themselves.
        pending.retain(|path| path.exists());
        sweep(folder);
        let mut builder = tempfile::Builder::new();
        builder.prefix(PREFIX).suffix(SUFFIX);
        // A temporary file is private unless told otherwise; the process's umask still applies to this.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let file = builder.tempfile_in(folder)?;
        pending.push(file.path().to_owned());
        Ok(Self { file: BufWriter::with_capacity(BUFFER_BYTES, file), target })
    }

    pub fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.file.write_all(bytes)
    }

    pub fn patch(&mut self, offset: u64, bytes: &[u8]) -> io::Result<()> {
        self.file.seek(SeekFrom::Start(offset))?;
        self.file.write_all(bytes)?;
        self.file.seek(SeekFrom::End(0)).map(drop)
    }

    /// What has been written, from an offset on.
    pub fn reread(&mut self, offset: u64) -> io::Result<Box<dyn BufRead + Send>> {
        self.file.flush()?;
        let mut opened = File::open(self.file.get_ref().path())?;
        opened.seek(SeekFrom::Start(offset))?;
        Ok(Box::new(BufReader::with_capacity(BUFFER_BYTES, opened)))
    }

    fn rename(self) -> io::Result<()> {
        let file = self.file.into_inner().map_err(io::IntoInnerError::into_error)?;
        let mut pending = PENDING.lock().unwrap_or_else(PoisonError::into_inner);
        let temporary = file.path().to_owned();
        let renamed = file.persist(&self.target).map(drop).map_err(|error| error.error);
        pending.retain(|path| *path != temporary);
        renamed
    }
}

/// Ends the process from whatever thread, for a signal: removes what is incomplete. What has been renamed stays.
pub fn abandon_and_exit(code: i32) -> ! {
    // Kept locked until the end, so that no file is begun or renamed meanwhile.
    let pending = PENDING.lock().unwrap_or_else(PoisonError::into_inner);
    for path in pending.iter() {
        // A file that is gone already is as good; there is nobody left to tell.
        let _ = fs::remove_file(path);
    }
    std::process::exit(code)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries =
            fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<String> = entries.collect();
        names.sort();
        names
    }

    #[test]
    fn nothing_is_seen_before_commit_and_only_the_file_after() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("part.gcode");
        let mut output = Output::create(&path).unwrap();
        output.write(b"G28\n").unwrap();
        assert!(!path.exists());
        output.commit().unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"G28\n");
        assert_eq!(names(folder.path()), ["part.gcode"]);
    }

    #[test]
    fn without_commit_the_old_file_stays_and_nothing_is_left() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("part.gcode");
        fs::write(&path, "old").unwrap();
        let mut output = Output::create(&path).unwrap();
        output.write(b"new").unwrap();
        drop(output);
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(names(folder.path()), ["part.gcode"]);
    }

    #[test]
    fn a_patch_replaces_what_was_written_and_writing_goes_on_at_the_end() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("part.gcode");
        let mut output = Output::create(&path).unwrap();
        output.write(b";TIME:0000\n").unwrap();
        output.patch(6, b"1234").unwrap();
        output.write(b"G28\n").unwrap();
        assert_eq!(output.written(), 15);
        assert!(output.patch(12, b"long").is_err(), "beyond the end");
        output.commit().unwrap();
        assert_eq!(fs::read(&path).unwrap(), b";TIME:1234\nG28\n");
    }

    #[test]
    fn what_a_killed_run_left_behind_is_removed_after_a_day() {
        let folder = tempfile::tempdir().unwrap();
        for (name, hours) in [(".pathwright-a.tmp", 25), (".pathwright-b.tmp", 23), ("c.tmp", 99)] {
            let file = File::create(folder.path().join(name)).unwrap();
            file.set_modified(std::time::SystemTime::now() - Duration::from_secs(hours * 3600)).unwrap();
        }
        drop(Output::create(&folder.path().join("part.gcode")).unwrap());
        assert_eq!(names(folder.path()), [".pathwright-b.tmp", "c.tmp"]);
    }

    #[test]
    fn a_missing_folder_and_a_folder_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let missing = Output::create(&folder.path().join("no/part.gcode")).unwrap_err();
        assert!(missing.to_string().ends_with("there is no such folder"), "{missing}");
        let taken = Output::create(folder.path()).unwrap_err();
        assert!(taken.to_string().ends_with("it is a folder"), "{taken}");
    }

    #[cfg(unix)]
    #[test]
    fn the_mode_of_the_file_that_is_replaced_is_kept() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("part.gcode");
        fs::write(&path, "old").unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
        let output = Output::create(&path).unwrap();
        output.commit().unwrap();
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o640);
    }

    #[cfg(unix)]
    #[test]
    fn a_new_file_has_the_mode_that_any_new_file_has() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let (path, other) = (folder.path().join("part.gcode"), folder.path().join("other"));
        Output::create(&path).unwrap().commit().unwrap();
        fs::write(&other, "").unwrap();
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&path), mode(&other));
    }

    #[cfg(unix)]
    #[test]
    fn a_write_protected_file_is_not_replaced() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("part.gcode");
        fs::write(&path, "old").unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o444)).unwrap();
        assert!(Output::create(&path).unwrap_err().to_string().contains("write-protected"));
    }

    #[cfg(unix)]
    #[test]
    fn a_link_stays_and_what_it_points_to_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let (link, path) = (folder.path().join("link"), folder.path().join("real.gcode"));
        std::os::unix::fs::symlink("real.gcode", &link).unwrap();
        for text in ["first", "second"] {
            let mut output = Output::create(&link).unwrap();
            output.write(text.as_bytes()).unwrap();
            output.commit().unwrap();
            assert_eq!(fs::read_to_string(&path).unwrap(), text);
            assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn devices_are_written_directly_and_a_full_one_says_so() {
        let mut output = Output::create(Path::new("/dev/null")).unwrap();
        output.write(b"G28\n").unwrap();
        output.patch(0, b"G29").unwrap();
        output.commit().unwrap();
        let mut output = Output::create(Path::new("/dev/full")).unwrap();
        output.write(b"G28\n").unwrap();
        assert!(output.commit().unwrap_err().to_string().contains("disk is full"));
    }
}
