//! Files by content: models and projects of jobs that wait, and results. No name of a client is part of a path.

use std::collections::HashMap;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use tempfile::{NamedTempFile, TempPath};

/// The folder of a server.
#[derive(Debug)]
pub struct Files {
    root: PathBuf,
    /// How many jobs need each input.
    held: Mutex<HashMap<String, usize>>,
}

/// The G-code of a result.
pub const GCODE: &str = "gcode";
/// Its summary.
pub const SUMMARY: &str = "summary.json";
/// The settings that were in force.
pub const SETTINGS: &str = "settings.json";

const INPUTS: &str = "inputs";
const RESULTS: &str = "results";
const TEMPORARY: &str = "tmp";

impl Files {
    /// Makes the folders that are not there, and removes what another run left unfinished.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn open(root: &Path) -> io::Result<Self> {
        let temporary = root.join(TEMPORARY);
        if temporary.exists() {
            fs::remove_dir_all(&temporary)?;
        }
        for folder in [INPUTS, RESULTS, TEMPORARY] {
            fs::create_dir_all(root.join(folder))?;
        }
        sync_folder(root)?;
        Ok(Self { root: root.to_owned(), held: Mutex::default() })
    }

    /// Removes inputs and results that nothing refers to.
    pub fn sweep(&self, is_input: impl Fn(&str) -> bool, is_result: impl Fn(&str) -> bool) -> io::Result<()> {
        for entry in fs::read_dir(self.root.join(INPUTS))? {
            let entry = entry?;
            if !is_input(&entry.file_name().to_string_lossy()) {
                fs::remove_file(entry.path())?;
            }
        }
        for entry in fs::read_dir(self.root.join(RESULTS))? {
            let entry = entry?;
            if !is_result(&entry.file_name().to_string_lossy()) {
                fs::remove_dir_all(entry.path())?;
            }
        }
        Ok(())
    }

    /// A temporary file, which goes when it is dropped.
    ///
    /// # Errors
    /// The disk is full, or the folder cannot be written.
    pub fn temporary(&self) -> io::Result<NamedTempFile> {
        NamedTempFile::new_in(self.root.join(TEMPORARY))
    }

    /// A path for a temporary file of a result, which goes when it is dropped.
    ///
    /// # Errors
    /// There is no current folder to which the server's is relative.
    pub fn temporary_path(&self, key: &str) -> io::Result<TempPath> {
        TempPath::try_from_path(self.root.join(TEMPORARY).join(key))
    }

    /// Keeps a complete file as the input of that hash until it is released as often as it was kept. When this returns it is on
    /// the disk.
    ///
    /// # Errors
    /// The disk is full, or the folder cannot be written.
    pub fn keep(&self, hash: &str, file: TempPath) -> io::Result<()> {
        File::open(&file)?.sync_all()?;
        let mut held = self.held.lock().unwrap_or_else(PoisonError::into_inner);
        if !held.contains_key(hash) {
            file.persist(self.input(hash)).map_err(|error| error.error)?;
            sync_folder(&self.root.join(INPUTS))?;
        }
        *held.entry(hash.to_owned()).or_default() += 1;
        Ok(())
    }

    /// Keeps an input that is there already.
    pub fn hold(&self, hash: &str) {
        *self.held.lock().unwrap_or_else(PoisonError::into_inner).entry(hash.to_owned()).or_default() += 1;
    }

    /// Whether a job needs an input.
    pub fn is_held(&self, hash: &str) -> bool {
        self.held.lock().unwrap_or_else(PoisonError::into_inner).contains_key(hash)
    }

    /// Removes an input, unless another job needs it.
    pub fn release(&self, hash: &str) {
        let mut held = self.held.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(count) = held.get_mut(hash) else { return };
        *count -= 1;
        if *count == 0 {
            held.remove(hash);
            // What stays is swept at the next start.
            let _ = fs::remove_file(self.input(hash));
        }
    }

    /// Where an input is.
    pub fn input(&self, hash: &str) -> PathBuf {
        self.root.join(INPUTS).join(hash)
    }

    /// The folder of a result.
    pub fn result(&self, key: &str) -> PathBuf {
        self.root.join(RESULTS).join(key)
    }

    /// Writes a file of a result, whole or not at all. When this returns it is on the disk.
    ///
    /// # Errors
    /// The disk is full, or the folder cannot be written.
    pub fn write_result(&self, key: &str, name: &str, contents: &[u8]) -> io::Result<()> {
        let mut file = self.temporary()?;
        file.write_all(contents)?;
        self.persist_result(key, name, file.into_temp_path())
    }

    /// The same of a temporary file.
    ///
    /// # Errors
    /// The disk is full, or the folder cannot be written.
    pub fn persist_result(&self, key: &str, name: &str, file: TempPath) -> io::Result<()> {
        let folder = self.result(key);
        fs::create_dir_all(&folder)?;
        File::open(&file)?.sync_all()?;
        file.persist(folder.join(name)).map_err(|error| error.error)?;
        sync_folder(&folder)?;
        sync_folder(&self.root.join(RESULTS))
    }

    /// Bytes of all files of a result.
    pub fn result_bytes(&self, key: &str) -> u64 {
        let entries = fs::read_dir(self.result(key)).into_iter().flatten().flatten();
        entries.filter_map(|entry| entry.metadata().ok()).map(|data| data.len()).sum()
    }

    /// Removes a result.
    pub fn remove_result(&self, key: &str) {
        // What stays is swept at the next start.
        let _ = fs::remove_dir_all(self.result(key));
    }
}

/// Names of new files are on the disk when this returns. Windows has no such call, and needs none.
fn sync_folder(folder: &Path) -> io::Result<()> {
    if cfg!(unix) { File::open(folder)?.sync_all() } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_input_stays_as_long_as_a_job_needs_it() {
        let folder = tempfile::tempdir().unwrap();
        let files = Files::open(folder.path()).unwrap();
        let write = || {
            let mut file = files.temporary().unwrap();
            file.write_all(b"solid").unwrap();
            files.keep("abc", file.into_temp_path()).unwrap();
        };
        write();
        write();
        files.release("abc");
        assert_eq!(fs::read(files.input("abc")).unwrap(), b"solid");
        files.release("abc");
        assert!(!files.input("abc").exists());
        assert_eq!(fs::read_dir(folder.path().join(TEMPORARY)).unwrap().count(), 0);
    }

    #[test]
    fn what_nothing_refers_to_is_swept() {
        let folder = tempfile::tempdir().unwrap();
        let files = Files::open(folder.path()).unwrap();
        for key in ["a", "b"] {
            files.write_result(key, "gcode", b"G28").unwrap();
        }
        files.sweep(|_| false, |key| key == "b").unwrap();
        assert!(!files.result("a").exists() && files.result_bytes("b") == 3);
    }
}
