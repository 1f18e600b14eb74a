//! A plate that is always sliced.

use std::sync::Arc;
use std::sync::atomic::Ordering;

use super::added::{Added, AddedFile};
use super::event::Event;
use super::layout;
use super::options::{Failure, Options};
use super::results::Results;
use super::work::{Shared, bytes_of};
use crate::job::{Job, JobError, ModelFile, ModelFiles, Project};
use crate::observer::Observer;
use crate::pipeline::Pipeline;
use crate::plate::{self, Face};
use crate::presets::Library;
use crate::profile;

/// Meshes with more triangles are simplified for display.
pub const DISPLAYED: usize = 200_000;
/// Faces that a model can be laid on.
const FACES: usize = 40;

/// A plate that is always sliced; see [the module](super).
///
/// It holds at most the models, what is kept between slicings and the results of two revisions: together
/// `models_bytes + 2 · kept_bytes` and the newest results, beside what a slicing itself needs.
pub struct Session {
    shared: Arc<Shared>,
}

/// A subscription, which ends when this is dropped.
pub struct Subscription {
    shared: Arc<Shared>,
    number: u64,
}

impl Session {
    /// A session without models.
    pub fn new(options: Options) -> Self {
        Self { shared: Arc::new(Shared::new(options)) }
    }

    /// Adds a file; of a project all its models, under names that are free.
    ///
    /// # Errors
    /// It is neither a model nor a project, or the session has no room for it.
    pub fn add(&self, name: &str, contents: &[u8]) -> Result<AddedFile, Failure> {
        let Some((mut project, files)) = Project::read(name, contents, &Observer::none())? else {
            return Ok(AddedFile { added: self.add_model(name, contents)?, project: None, files: None });
        };
        let mut all = Vec::new();
        for (file, read) in files {
            let read = Arc::into_inner(read).ok_or_else(|| Failure::Limit("the file is in use".into()))?;
            let added = self.add_file(read)?;
            let models = project.models.iter_mut().filter(|model| model.file == file);
            models.for_each(|model| model.file.clone_from(&added.file));
            all.push(added);
        }
        let added = Added {
            file: all.first().map(|added| added.file.clone()).unwrap_or_default(),
            bytes: contents.len(),
            objects: all.iter().flat_map(|added| added.objects.clone()).collect(),
        };
        Ok(AddedFile { added, project: Some(project), files: Some(all) })
    }

    /// Reads and repairs a model file; takes as long as that does.
    ///
    /// # Errors
    /// It is no model, or the session has no room for it.
    pub fn add_model(&self, name: &str, contents: impl Into<Arc<[u8]>>) -> Result<Added, Failure> {
        let contents = contents.into();
        self.shared.check_room(contents.len())?;
        let name = self.shared.state().unique(name);
        let file = ModelFile::read(&name, contents, &Observer::none())?;
        self.add_file(file)
    }

    /// Adds a model file that has been read.
    ///
    /// # Errors
    /// The session has no room for it.
    pub fn add_file(&self, file: ModelFile) -> Result<Added, Failure> {
        self.shared.check_room(bytes_of(&file))?;
        let mut added = Added::of(&file);
        let mut state = self.shared.state();
        added.file = state.unique(file.name());
        state.files.insert(added.file.clone(), Arc::new(file));
        Ok(added)
    }

    /// Takes other presets, whose names mean these from now on; they wait for a slicing that runs.
    pub fn set_library(&self, library: Arc<Library>) {
        self.shared.set_library(library);
    }

    /// The models, by their names.
    pub fn models(&self) -> ModelFiles {
        self.shared.state().files.clone()
    }

    /// An object of a model in packed form; see [`Mesh::packed`](crate::mesh::Mesh::packed).
    ///
    /// # Errors
    /// There is no such model or object.
    pub fn mesh(&self, file: &str, object: usize, most: usize) -> Result<Vec<u8>, Failure> {
        self.shared.with_mesh(file, object, |mesh| mesh.packed(most))
    }

    /// The flat faces of an object that it can be laid on, the largest first, in the coordinates of [`Session::mesh`].
    ///
    /// # Errors
    /// There is no such model or object.
    pub fn faces(&self, file: &str, object: usize) -> Result<Vec<Face>, Failure> {
        self.shared.with_mesh(file, object, |mesh| {
            let [low, high] = mesh.bounds();
            let origin = [(low[0] + high[0]) / 2.0, (low[1] + high[1]) / 2.0, low[2]];
            let mut faces = plate::faces(mesh, FACES);
            let corners = faces.iter_mut().flat_map(|face| &mut face.outline);
            corners.for_each(|corner| *corner = [0, 1, 2].map(|i| corner[i] - origin[i]));
            faces
        })
    }

    /// Takes a project in place of all before; their slicing ends at once, and this one's begins. The number of the
    /// revision.
    pub fn set_project(&self, project: Project) -> u64 {
        self.shared.want(vec![Arc::new(project)])
    }

    /// Slices two projects one after the other, in place of all before. The numbers of the revisions.
    pub fn compare(&self, [a, b]: [Project; 2]) -> [u64; 2] {
        let first = self.shared.want(vec![Arc::new(a), Arc::new(b)]);
        [first, first + 1]
    }

    /// The project of the last revision.
    pub fn project(&self) -> Option<Arc<Project>> {
        self.shared.state().project.clone()
    }

    /// Tells of everything that is known of the last revision, and from then on of everything new, until the subscription is
    /// dropped or `false` comes back. It is called while the session waits: it must be quick and ask the session nothing.
    pub fn subscribe(&self, listener: impl Fn(&Event) -> bool + Send + 'static) -> Subscription {
        let number = self.shared.state().listen(Box::new(listener));
        Subscription { shared: self.shared.clone(), number }
    }

    /// What came of a revision; `None`: nothing, or it is no longer kept.
    pub fn results(&self, revision: u64) -> Option<Results> {
        self.shared.state().results(revision).cloned()
    }

    /// The last revision that was asked for.
    pub fn latest(&self) -> u64 {
        self.shared.state().latest
    }

    /// The settings of a project in force, with their sources.
    ///
    /// # Errors
    /// Everything that is wrong with them.
    pub fn settings(&self, project: &Project) -> Result<profile::Resolved, Failure> {
        Ok(project.resolve(self.shared.library().as_deref()).map_err(JobError::from)?)
    }

    /// The job of a project.
    ///
    /// # Errors
    /// Models that are not there, settings that are wrong.
    pub fn job(&self, project: &Project) -> Result<Job, Failure> {
        Ok(project.job(&self.models(), self.shared.library().as_deref())?)
    }

    /// The project with positions for all models.
    ///
    /// # Errors
    /// As [`Session::job`]; models that do not fit together.
    pub fn arrange(&self, project: &Project) -> Result<Project, Failure> {
        let (job, settings) = (self.job(project)?, self.settings(project)?.settings);
        Ok(layout::arranged(project, &self.models(), &job, &settings, &Observer::none())?)
    }

    /// The project with a model turned to need the least support.
    ///
    /// # Errors
    /// There is no such model.
    pub fn orient(&self, project: &Project, model: usize) -> Result<Project, Failure> {
        if model >= project.models.len() {
            return Err(Failure::Missing { what: format!("model {model} in the project") });
        }
        Ok(layout::upright(project.clone(), model, &self.models())?)
    }

    /// The project as a file.
    ///
    /// # Errors
    /// As [`Session::job`].
    pub fn project_file(&self, project: &Project) -> Result<Vec<u8>, Failure> {
        let (job, settings) = (self.job(project)?, self.settings(project)?.settings);
        Ok(Pipeline.project_file(project, &self.models(), &job, &settings, &Observer::none())?)
    }

    /// Ends what is under way. Nobody is told anything more, and what is held goes.
    pub fn close(&self) {
        self.shared.first.store(u64::MAX, Ordering::Relaxed);
        self.shared.state().close();
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        self.close();
    }
}

impl Drop for Subscription {
    fn drop(&mut self) {
        self.shared.state().forget(self.number);
    }
}
