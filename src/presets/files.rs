//! Where files of presets are read from: this machine, or files that a caller has in memory.

use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::limits;

/// Files and folders that presets are read from. Without a list of its own: those of this machine.
#[derive(Clone, Debug, Default)]
pub struct Files(Option<Arc<BTreeMap<PathBuf, Vec<u8>>>>);

impl Files {
    /// These files and no others; their folders are those that their paths name.
    pub fn given(files: impl IntoIterator<Item = (PathBuf, Vec<u8>)>) -> Self {
        Self(Some(Arc::new(files.into_iter().collect())))
    }

    /// The whole of a file.
    ///
    /// # Errors
    /// It cannot be read.
    pub(super) fn read(&self, path: &Path) -> Result<Vec<u8>, String> {
        let read = |error: io::Error| format!("cannot be read: {error}");
        let Some(files) = &self.0 else { return std::fs::read(path).map_err(read) };
        files.get(path).cloned().ok_or_else(|| read(io::ErrorKind::NotFound.into()))
    }

    /// A file as UTF-8.
    ///
    /// # Errors
    /// It cannot be read, or is something else.
    pub(super) fn text(&self, path: &Path) -> Result<String, String> {
        String::from_utf8(self.read(path)?).map_err(|_| "cannot be read: it is no UTF-8".into())
    }

    /// A file that must not be larger than presets are.
    ///
    /// # Errors
    /// It cannot be read, or is larger.
    pub(super) fn small(&self, path: &Path) -> Result<Vec<u8>, String> {
        let bytes = match &self.0 {
            Some(files) => files.get(path).map_or(0, Vec::len) as u64,
            None => std::fs::metadata(path).map_or(0, |found| found.len()),
        };
        if bytes > limits::PRESETS_BYTES {
            return Err(format!("is larger than {} MB", limits::PRESETS_BYTES >> 20));
        }
        self.read(path)
    }

    /// What is in a folder, by name.
    pub(super) fn entries(&self, folder: &Path) -> Vec<PathBuf> {
        let mut entries: Vec<PathBuf> = match &self.0 {
            None => {
                std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path()).collect()
            }
            Some(_) => self
                .within(folder)
                .filter_map(|path| {
                    let name = path.strip_prefix(folder).ok()?.components().next()?;
                    Some(folder.join(name))
                })
                .collect(),
        };
        entries.sort();
        entries.dedup();
        entries
    }

    pub(super) fn is_dir(&self, path: &Path) -> bool {
        if self.0.is_none() {
            path.is_dir()
        } else {
            !self.is_file(path) && self.within(path).next().is_some()
        }
    }

    pub(super) fn is_file(&self, path: &Path) -> bool {
        self.0.as_ref().map_or_else(|| path.is_file(), |files| files.contains_key(path))
    }

    pub(super) fn exists(&self, path: &Path) -> bool {
        if self.0.is_none() { path.exists() } else { self.within(path).next().is_some() }
    }

    /// Given files at or below a path.
    fn within<'a>(&'a self, path: &'a Path) -> impl Iterator<Item = &'a PathBuf> {
        // Paths are in the order of their parts: what is in a folder follows it at once.
        let files = self.0.iter().flat_map(move |files| files.range(path.to_owned()..));
        files.map(|(path, _)| path).take_while(move |below| below.starts_with(path))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn given_files_are_in_the_folders_that_their_paths_name() {
        let names = ["a/x.ini", "a/b/y.ini", "a/b/z.ini", "a-b/w.ini", "c.ini"];
        let files = Files::given(names.map(|name| (PathBuf::from(name), name.into())));
        let entries = |folder: &str| -> Vec<String> {
            files.entries(Path::new(folder)).iter().map(|path| path.display().to_string()).collect()
        };
        assert_eq!(entries("a"), ["a/b", "a/x.ini"]);
        assert_eq!(entries("a/b"), ["a/b/y.ini", "a/b/z.ini"]);
        assert!(files.is_dir(Path::new("a")) && !files.is_file(Path::new("a")));
        assert!(files.is_file(Path::new("a/x.ini")) && !files.is_dir(Path::new("a/x.ini")));
        assert!(!files.exists(Path::new("a/x")) && !files.exists(Path::new("d")));
        assert_eq!(files.text(Path::new("a/b/z.ini")).unwrap(), "a/b/z.ini");
        assert!(files.read(Path::new("a/b")).unwrap_err().starts_with("cannot be read"));
    }
}
