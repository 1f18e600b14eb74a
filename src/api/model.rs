//! Models as input.

use std::path::{Path, PathBuf};

use crate::job::{JobError, JobModel};
use crate::mesh::{self, Mesh, Transform};
use crate::observer::Observer;
use crate::parallel;
use crate::pipeline::load;
use crate::plate::{self, Line};
use crate::profile::Settings;

/// A model: the objects of a file, or a mesh, with their transformation.
///
/// # Examples
/// ```
/// use pathwright::Model;
///
/// let model = Model::read("models/calibration_cube.stl")?.scaled(1.5).rotated([0.0, 0.0, 45.0]).copies(2);
/// # let _ = model;
/// # Ok::<(), pathwright::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Model {
    path: PathBuf,
    objects: Vec<mesh::Model>,
    transform: Transform,
    at_mm: Option<[f64; 3]>,
    copies: usize,
}

impl Model {
    /// Reads and repairs a file (STL, 3MF or OBJ).
    ///
    /// # Errors
    /// The file cannot be read, is no model, or holds nothing that has a volume.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, JobError> {
        let path = path.as_ref();
        Ok(Self::of(path, mesh::load_objects(path)?))
    }

    /// As [`Model::read`], unless the observer cancels it.
    ///
    /// # Errors
    /// As [`Model::read`]; [`Error::Cancelled`](JobError::Cancelled).
    pub fn read_watched(path: impl AsRef<Path>, observer: &Observer<'_>) -> Result<Self, JobError> {
        let path = path.as_ref();
        let objects = parallel::run(None, observer, |workers| mesh::load_watched(path, workers));
        Ok(Self::of(path, objects.ok_or(JobError::Cancelled)??))
    }

    /// As [`Model::read`], from the file's contents; `name` is what messages call it.
    ///
    /// # Errors
    /// As [`Model::read`].
    pub fn from_bytes(name: &str, contents: &[u8]) -> Result<Self, JobError> {
        let path = Path::new(name);
        Ok(Self::of(path, mesh::objects_from_bytes(path, contents)?))
    }

    fn of(path: &Path, objects: Vec<mesh::Model>) -> Self {
        Self { path: path.to_owned(), objects, transform: Transform::default(), at_mm: None, copies: 1 }
    }

    /// What messages and object labels call it.
    #[must_use]
    pub fn named(mut self, name: &str) -> Self {
        self.path = name.into();
        self
    }

    /// Scaled by a factor.
    #[must_use]
    pub fn scaled(mut self, factor: f64) -> Self {
        self.transform.scale = self.transform.scale.map(|scale| scale * factor);
        self
    }

    /// Turned about X, then Y, then Z, by this many degrees.
    #[must_use]
    pub fn rotated(mut self, degrees: [f64; 3]) -> Self {
        self.transform.rotate_deg = degrees;
        self
    }

    /// Standing on the bed with the middle of its box, seen from above, and its lowest point there (the bed's coordinates,
    /// millimetres). Either all models of a plate have a position or none has.
    #[must_use]
    pub fn standing_at(mut self, at_mm: [f64; 3]) -> Self {
        self.at_mm = Some(at_mm);
        self
    }

    /// Number of copies.
    #[must_use]
    pub fn copies(mut self, copies: usize) -> Self {
        self.copies = copies;
        self
    }

    /// The meshes, each with what was found and repaired.
    pub fn objects(&self) -> &[mesh::Model] {
        &self.objects
    }

    /// What it prints, each body standing on z = 0, with its name; see [`check_against`](crate::check_against).
    ///
    /// # Errors
    /// As [`Plate::add`](super::Plate::add).
    pub fn standing_bodies(self, settings: &Settings) -> Result<Vec<(String, Mesh)>, JobError> {
        let line = Line::thinnest(settings);
        let model = plate::Model::new(&self.path, self.objects, None, &self.transform, line, 1)?;
        Ok(model.layout.standing_bodies())
    }

    pub(super) fn prepared(self, settings: &Settings) -> Result<plate::Model, JobError> {
        let copies = u32::try_from(self.copies).unwrap_or(u32::MAX);
        let wanted = JobModel { transform: self.transform, at_mm: self.at_mm, copies, ..self.path.into() };
        load::model(&wanted, self.objects, false, settings)
    }
}

impl From<Mesh> for Model {
    fn from(mesh: Mesh) -> Self {
        Self::of(Path::new("object"), vec![mesh.into()])
    }
}
