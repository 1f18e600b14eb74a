//! Where G-code goes: whole, or not at all.
//!
//! A file is written under another name in the same folder and renamed when it is complete, so that a
//! printer that watches the folder never sees half a job. A device, a pipe or standard output cannot be renamed or
//! patched: what goes there is held back and written in one go, so that its bytes are those of the file.

#[cfg(feature = "cli")]
mod file;

#[cfg(feature = "cli")]
use std::io::Write;
use std::io::{self, BufRead, ErrorKind};
#[cfg(feature = "cli")]
use std::path::{Path, PathBuf};

#[cfg(feature = "cli")]
use file::{Opened, Pending, Stream};
#[cfg(feature = "cli")]
pub use file::{abandon_and_exit, resolve_links};

#[cfg(feature = "cli")]
use crate::gcode::{self, BinaryMetadata, Parts};

/// An operation on an output that failed.
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
        ErrorKind::PermissionDenied => format!("cannot be written: {error}; choose another path with -o"),
        _ => format!("cannot be written: {error}"),
    }
}

/// A destination that is being written. Dropped without [`Output::commit`], it leaves nothing behind.
#[derive(Debug)]
pub struct Output {
    name: String,
    written: u64,
    sink: Sink,
    /// What is written is text for a file of another form.
    #[cfg(feature = "cli")]
    packed: Option<Box<Packed>>,
}

/// A file that is made of what is written, when it is complete.
#[cfg(feature = "cli")]
#[derive(Debug)]
struct Packed {
    output: Output,
    packing: Packing,
}

/// What G-code is packed as.
#[cfg(feature = "cli")]
#[derive(Debug)]
enum Packing {
    Binary(BinaryMetadata),
    /// With parts beside it.
    Package(Parts),
}

#[derive(Debug)]
enum Sink {
    #[cfg(feature = "cli")]
    File(Pending),
    Memory(Vec<u8>),
    /// Held back for what cannot be patched.
    #[cfg(feature = "cli")]
    Direct(Vec<u8>, Stream),
}

impl Output {
    /// Nowhere: the bytes are for [`Output::into_bytes`].
    pub fn memory() -> Self {
        Self::of("memory".into(), Sink::Memory(Vec::new()))
    }

    fn of(name: String, sink: Sink) -> Self {
        Self {
            name,
            written: 0,
            sink,
            #[cfg(feature = "cli")]
            packed: None,
        }
    }

    /// The bytes of an output in memory; none of a file.
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
    /// As [`Output::write`], and if the position has not been written yet.
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

    /// The bytes written so far, from an offset on.
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

#[cfg(feature = "cli")]
impl Output {
    /// Standard output.
    pub fn stdout() -> Self {
        Self::of("standard output".into(), Sink::Direct(Vec::new(), Stream::Stdout))
    }

    /// An output without a file: its bytes can be read back once.
    ///
    /// # Errors
    /// If the system has no folder for temporary files.
    pub fn nowhere() -> Result<Self, OutputError> {
        Self::temporary(&std::env::temp_dir(), "a temporary file".to_owned())
    }

    fn temporary(folder: &Path, name: String) -> Result<Self, OutputError> {
        match Pending::create(folder, PathBuf::new()) {
            Ok(pending) => Ok(Self::of(name, Sink::File(pending))),
            Err(source) => Err(OutputError { path: name, source }),
        }
    }

    /// A file, written as a temporary one beside it, which gets the mode of the file that it will replace. What a
    /// symbolic link points to is replaced, not the link. Something that is no regular file is written directly.
    ///
    /// # Errors
    /// If it is a folder or write-protected, or the folder does not exist or cannot be written.
    pub fn create(path: &Path) -> Result<Self, OutputError> {
        let name = path.display().to_string();
        match file::open(path) {
            Ok(Opened::File(file)) => Ok(Self::of(name, Sink::File(file))),
            Ok(Opened::Device(device)) => {
                Ok(Self::of(name, Sink::Direct(Vec::new(), Stream::Device(device))))
            }
            Err(source) => Err(OutputError { path: name, source }),
        }
    }

    /// A file of binary G-code. What is written is text: it goes to a temporary file beside the first, which it is made of
    /// in [`Output::commit`].
    ///
    /// # Errors
    /// As [`Output::create`].
    pub fn create_binary(path: &Path, metadata: BinaryMetadata) -> Result<Self, OutputError> {
        Self::create_packed(path, Packing::Binary(metadata))
    }

    /// A package with G-code. What is written is text, as with [`Output::create_binary`]. `parts`: what else is in the package.
    ///
    /// # Errors
    /// As [`Output::create`].
    pub(crate) fn create_package(path: &Path, parts: Parts) -> Result<Self, OutputError> {
        Self::create_packed(path, Packing::Package(parts))
    }

    fn create_packed(path: &Path, packing: Packing) -> Result<Self, OutputError> {
        let output = Self::create(path)?;
        let folder = match &output.sink {
            Sink::File(file) => file.folder(),
            _ => std::env::temp_dir(),
        };
        let text = Self::temporary(&folder, output.name.clone())?;
        Ok(Self { packed: Some(Box::new(Packed { output, packing })), ..text })
    }

    /// Makes the file of the text.
    fn pack(mut self, packed: Packed) -> Result<Self, OutputError> {
        let Packed { mut output, packing } = packed;
        let name = self.name.clone();
        let failed = |source: io::Error| OutputError { path: name.clone(), source };
        match &packing {
            Packing::Binary(metadata) => {
                let contents = gcode::contents(self.reread(0)?, metadata).map_err(failed)?;
                gcode::pack_text(&contents, self.reread(0)?, &mut Appending(&mut output))
            }
            Packing::Package(parts) => {
                gcode::write_package(parts, self.reread(0)?, &mut Appending(&mut output))
            }
        }
        .map_err(failed)?;
        Ok(output)
    }

    /// Gives the file another name in its folder, which the complete output moves to; nothing else has one.
    pub fn rename(&mut self, name: &str) {
        match &mut self.packed {
            Some(packed) => packed.output.rename(name),
            None => {
                if let Sink::File(file) = &mut self.sink {
                    self.name = file.retarget(name).display().to_string();
                }
            }
        }
    }

    /// Moves the complete output to its path.
    ///
    /// # Errors
    /// As [`Output::write`]; then the file at the path is as it was before.
    pub fn commit(mut self) -> Result<(), OutputError> {
        if let Some(packed) = self.packed.take() {
            return self.pack(*packed)?.commit();
        }
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

/// Appends to an output.
#[cfg(feature = "cli")]
struct Appending<'a>(&'a mut Output);

#[cfg(feature = "cli")]
impl Write for Appending<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.write(bytes).map_err(|error| error.source)?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(all(test, feature = "cli"))]
mod tests {
    use super::*;
    use std::fs::{self, File};
    use std::time::Duration;

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
