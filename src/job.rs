//! The tasks of a run, and the errors that it can end with.

pub mod catalog;
mod command;
mod error;
mod file;
mod key;
mod model;
mod objects;
mod project;
mod resolve;
mod sources;

use std::path::PathBuf;

use crate::mesh::Transform;
use crate::motion::PauseAt;
use crate::observer::Observer;
use crate::order::OrderStrategy;
use crate::order::compare::StrategyRow;
use crate::order::compare_tools::ToolOrderRow;
use crate::output::Output;
use crate::profile::Settings;
use crate::report::{ModelInfo, PaperRow, Reordered, Summary};

pub use error::{CheckError, FitError, InputError, JobError};
#[cfg(feature = "serve")]
pub(crate) use model::digest;
#[cfg(feature = "hosts")]
pub(crate) use model::hexadecimal;
pub use model::{JobModel, ModelFile, ModelFiles, ModelSource};
pub use objects::ObjectSettings;
pub use project::{ModelRole, PresetNames, Project, ProjectModel};
pub use sources::Sources;

/// Models for one plate, and what to do with them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Job {
    /// What is printed, in the order in which it is placed. Either all have a position or none has.
    pub models: Vec<JobModel>,
    /// Bodies in which support is enforced; those without a position are placed as the first model is.
    pub support_enforcers: Vec<JobModel>,
    /// Bodies in which nothing is supported; those without a position are placed as the first model is.
    pub support_blockers: Vec<JobModel>,
    /// Moves the plate away from where it would be placed, millimetres; a negative Z cuts off the bottom.
    pub translate_mm: [f64; 3],
    /// Shrink what is larger than the bed.
    pub scale_to_fit: bool,
    /// Settings that some objects have of their own, found by their names.
    pub objects: Vec<ObjectSettings>,
    /// Where the print stops for a filament change.
    pub pauses: Vec<PauseAt>,
    /// Where it stops for filament of another color.
    pub color_changes: Vec<PauseAt>,
    /// Date of the header, seconds since 1970; `None`: a fixed one, so that the same input gives the same bytes.
    pub dated: Option<u64>,
    /// Print also what begins in mid-air, instead of refusing it.
    pub allow_floating: bool,
    /// Prove how near to the shortest possible the order is.
    pub certify: bool,
    /// Worker threads; 0: as `RAYON_NUM_THREADS` says, or else all cores; `None`: those that the caller has.
    pub threads: Option<usize>,
}

impl Job {
    /// Models from files, as they are, one plate.
    pub fn of(models: impl IntoIterator<Item = PathBuf>) -> Self {
        Self { models: models.into_iter().map(JobModel::from).collect(), ..Self::default() }
    }

    /// The same with so many of each model.
    #[must_use]
    pub fn with_copies(mut self, copies: u32) -> Self {
        self.models.iter_mut().for_each(|model| model.copies = copies);
        self
    }

    /// The same with every model scaled and turned so.
    #[must_use]
    pub fn transformed(mut self, transform: Transform) -> Self {
        self.all_models().for_each(|model| model.transform = transform);
        self
    }

    /// Every model, what is printed first.
    fn all_models(&mut self) -> impl Iterator<Item = &mut JobModel> {
        self.models.iter_mut().chain(&mut self.support_enforcers).chain(&mut self.support_blockers)
    }
}

/// How a G-code file is put into another order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReorderJob {
    /// The file.
    pub file: PathBuf,
    /// Draw no open path backwards.
    pub keep_direction: bool,
    /// Whether there may be more retractions than before, where that saves more travel than they are worth.
    pub more_retractions: bool,
    /// Worker threads; 0: as `RAYON_NUM_THREADS` says, or else all cores; `None`: those that the caller has.
    pub threads: Option<usize>,
}

/// The operations behind the command line.
pub trait Engine: Sync {
    /// Slices one plate and writes its G-code. The caller commits the output.
    ///
    /// # Errors
    /// See [`JobError`].
    fn slice(
        &self,
        job: &Job,
        settings: &Settings,
        output: &mut Output,
        observer: &Observer<'_>,
    ) -> Result<Summary, JobError>;

    /// Orders the layers of one plate by each strategy, side by side; with `job.certify`, against a lower bound.
    ///
    /// # Errors
    /// See [`JobError`].
    fn compare(
        &self,
        job: &Job,
        settings: &Settings,
        strategies: &[OrderStrategy],
        observer: &Observer<'_>,
    ) -> Result<Vec<StrategyRow>, JobError>;

    /// Compares orders of the tools of one plate; an engine that has none gives no rows.
    ///
    /// # Errors
    /// See [`JobError`].
    fn compare_tools(
        &self,
        _job: &Job,
        _settings: &Settings,
        _observer: &Observer<'_>,
    ) -> Result<Vec<ToolOrderRow>, JobError> {
        Ok(Vec::new())
    }

    /// The rows of the paper's table for a file; the first row is the file as it is. A model is sliced first.
    ///
    /// # Errors
    /// See [`JobError`].
    fn paper(
        &self,
        job: &Job,
        settings: &Settings,
        observer: &Observer<'_>,
    ) -> Result<Vec<PaperRow>, JobError>;

    /// Puts a G-code file into another order. The caller commits the output, if anything changed; otherwise what
    /// was written is of no use.
    ///
    /// # Errors
    /// See [`JobError`]; [`JobError::Check`] if the result does not print the same.
    fn reorder(
        &self,
        job: &ReorderJob,
        settings: &Settings,
        output: &mut Output,
        observer: &Observer<'_>,
    ) -> Result<Reordered, JobError>;

    /// Reports the contents of the only model of a job, and whether it fits.
    ///
    /// # Errors
    /// [`JobError::Mesh`] if it cannot be read.
    fn info(&self, job: &Job, settings: &Settings) -> Result<ModelInfo, JobError>;
}
