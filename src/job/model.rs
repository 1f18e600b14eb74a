//! A model of a job: where it is read from, and what is done with it.

use std::collections::BTreeMap;
use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use rustc_hash::FxHashMap;
use sha2::{Digest, Sha256};

use crate::mesh::{self, Mesh, MeshError, MeshReport, Transform};
use crate::observer::Observer;
use crate::parallel::{self, Workers};
use crate::profile::Settings;

use super::error::JobError;

/// A model of a job.
#[derive(Clone, Debug, PartialEq)]
pub struct JobModel {
    /// Where it is read from.
    pub source: ModelSource,
    /// The object of the file, counted from 0; `None`: all of them, in the file's layout.
    pub object: Option<usize>,
    /// How it is scaled and turned.
    pub transform: Transform,
    /// Where the middle of its box, seen from above, and its lowest point are, in the bed's coordinates, millimetres; `None`:
    /// it is arranged. Parts too thin for a line do not count.
    pub at_mm: Option<[f64; 3]>,
    /// How many of it; at least 1, and 1 where it has a position.
    pub copies: u32,
    /// Settings of its own; of use are those of [`ObjectSettings::SECTIONS`](super::ObjectSettings::SECTIONS).
    pub settings: Option<Arc<Settings>>,
}

impl JobModel {
    /// A model as it is.
    pub fn new(source: impl Into<ModelSource>) -> Self {
        Self {
            source: source.into(),
            object: None,
            transform: Transform::default(),
            at_mm: None,
            copies: 1,
            settings: None,
        }
    }

    /// What messages call the file.
    pub fn path(&self) -> &Path {
        self.source.path()
    }

    /// Reads the files of models now, each once, if they are small.
    #[cfg_attr(not(feature = "cli"), expect(dead_code, reason = "who has no files has read them"))]
    pub(crate) fn read_small(models: &mut [Self]) {
        let mut read: FxHashMap<PathBuf, Option<Arc<ModelFile>>> = FxHashMap::default();
        for source in models.iter_mut().map(|model| &mut model.source) {
            let ModelSource::Path(path) = source else { continue };
            if let Some(file) = read.entry(path.clone()).or_insert_with(|| small(path).map(Arc::new)) {
                *source = file.clone().into();
            }
        }
    }
}

impl<T: Into<ModelSource>> From<T> for JobModel {
    fn from(source: T) -> Self {
        Self::new(source)
    }
}

/// Files up to this size are read while something else is done.
const SMALL_BYTES: u64 = 1 << 20;

/// A small file, read and repaired. One that cannot be read is left to whoever reads it later, and is told why.
fn small(path: &Path) -> Option<ModelFile> {
    let file = fs::metadata(path).ok().filter(|file| file.is_file() && file.len() <= SMALL_BYTES);
    let bytes = file.and_then(|_| fs::read(path).ok())?;
    ModelFile::read(path.to_str()?, bytes, &Observer::none()).ok()
}

/// Where a model is read from.
#[derive(Clone, Debug)]
pub enum ModelSource {
    /// A file.
    Path(PathBuf),
    /// A file's contents.
    Bytes {
        /// What messages call the file.
        name: String,
        /// Its contents.
        bytes: Arc<[u8]>,
    },
    /// A file that has been read and repaired.
    Read(Arc<ModelFile>),
}

impl ModelSource {
    /// What messages call the file.
    pub fn path(&self) -> &Path {
        match self {
            Self::Path(path) => path,
            Self::Bytes { name, .. } => Path::new(name),
            Self::Read(file) => Path::new(&file.name),
        }
    }

    /// The objects of the file, repaired.
    pub(crate) fn objects(&self, workers: Workers<'_>) -> Result<Vec<mesh::Model>, MeshError> {
        match self {
            Self::Path(path) => mesh::load_watched(path, workers),
            Self::Bytes { name, bytes } => mesh::objects_watched(Path::new(name), bytes, workers),
            Self::Read(file) => Ok(file.objects.clone()),
        }
    }

    /// The file as one mesh.
    pub(crate) fn whole(&self) -> Result<(Mesh, MeshReport), MeshError> {
        match self {
            Self::Path(path) => mesh::load(path),
            Self::Bytes { name, bytes } => mesh::from_bytes(Path::new(name), bytes),
            Self::Read(file) => file.whole(),
        }
    }
}

impl PartialEq for ModelSource {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Path(a), Self::Path(b)) => a == b,
            (Self::Bytes { name: a, bytes: x }, Self::Bytes { name: b, bytes: y }) => {
                a == b && (Arc::ptr_eq(x, y) || x == y)
            }
            (Self::Read(a), Self::Read(b)) => {
                Arc::ptr_eq(a, b) || (a.name == b.name && a.digest() == b.digest())
            }
            _ => false,
        }
    }
}

impl From<PathBuf> for ModelSource {
    fn from(path: PathBuf) -> Self {
        Self::Path(path)
    }
}

impl From<String> for ModelSource {
    fn from(path: String) -> Self {
        Self::Path(path.into())
    }
}

impl From<&str> for ModelSource {
    fn from(path: &str) -> Self {
        Self::Path(path.into())
    }
}

impl From<&Path> for ModelSource {
    fn from(path: &Path) -> Self {
        Self::Path(path.to_owned())
    }
}

impl From<Arc<ModelFile>> for ModelSource {
    fn from(file: Arc<ModelFile>) -> Self {
        Self::Read(file)
    }
}

/// Model files by their names.
pub type ModelFiles = BTreeMap<String, Arc<ModelFile>>;

/// A model file in memory, read and repaired once for any number of jobs.
pub struct ModelFile {
    name: String,
    bytes: Arc<[u8]>,
    objects: Vec<mesh::Model>,
    whole: OnceLock<(Mesh, MeshReport)>,
    digest: OnceLock<String>,
}

impl ModelFile {
    /// Reads and repairs a file's contents (STL, 3MF or OBJ); `name` is what messages call it.
    ///
    /// # Errors
    /// See [`MeshError`]; [`JobError::Cancelled`] if the observer cancels it.
    pub fn read(name: &str, bytes: impl Into<Arc<[u8]>>, observer: &Observer<'_>) -> Result<Self, JobError> {
        let bytes = bytes.into();
        let read = |workers: Workers<'_>| mesh::objects_watched(Path::new(name), &bytes, workers);
        let objects = parallel::run(None, observer, read).ok_or(JobError::Cancelled)??;
        Ok(Self { name: name.to_owned(), bytes, objects, whole: OnceLock::new(), digest: OnceLock::new() })
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its contents.
    pub fn bytes(&self) -> &Arc<[u8]> {
        &self.bytes
    }

    /// Its objects, each with what was found and repaired.
    pub fn objects(&self) -> &[mesh::Model] {
        &self.objects
    }

    /// SHA-256 of its contents, hexadecimal.
    pub fn digest(&self) -> &str {
        self.digest.get_or_init(|| digest(&self.bytes))
    }

    /// All objects as one mesh, at their positions.
    fn whole(&self) -> Result<(Mesh, MeshReport), MeshError> {
        if let Some(whole) = self.whole.get() {
            return Ok(whole.clone());
        }
        let whole = mesh::from_bytes(Path::new(&self.name), &self.bytes)?;
        Ok(self.whole.get_or_init(|| whole).clone())
    }
}

impl fmt::Debug for ModelFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let bytes = self.bytes.len();
        f.debug_struct("ModelFile").field("name", &self.name).field("bytes", &bytes).finish_non_exhaustive()
    }
}

/// SHA-256 of bytes, hexadecimal.
pub(crate) fn digest(bytes: &[u8]) -> String {
    hexadecimal(&Sha256::digest(bytes))
}

/// Bytes as two digits each.
pub(crate) fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_is_named_twice_is_read_once() {
        let mut models = ["models/calibration_cube.stl", "models/none.stl", "models/calibration_cube.stl"]
            .map(JobModel::new);
        JobModel::read_small(&mut models);
        let [ModelSource::Read(first), ModelSource::Path(_), ModelSource::Read(second)] =
            models.map(|model| model.source)
        else {
            panic!("small files that are there are read, others left")
        };
        assert!(Arc::ptr_eq(&first, &second));
    }
}
