//! Wires the stages.
//!
//! Sections of all layers come first, since shells look at neighbours. Then layers flow in batches through
//! toolpaths, ordering, motion and formatting, each stage parallel over the layers (ordering: over chunks of
//! layers) and at work on a batch of its own, and their bytes are checked and go out in order.

mod compare;
mod finished;
mod inspect;
mod kept;
pub(crate) mod load;
mod ordering;
mod paper;
mod preheat;
mod print;
mod project;
mod reorder;
mod room;
mod rounds;
mod staged;
mod statistics;
mod tools;
mod writer;

use std::path::Path;

use crate::job::{Engine, Job, JobError, ModelFiles, Project, ReorderJob};
use crate::motion::LayerMoves;
use crate::observer::Observer;
use crate::order::OrderStrategy;
use crate::order::compare::StrategyRow;
use crate::order::compare_tools::ToolOrderRow;
use crate::output::Output;
use crate::parallel::{self, Workers};
use crate::plate::{Model, PlacementError, Plate};
use crate::profile::Settings;
use crate::report::{ModelInfo, PaperRow, Reordered, Summary};
use crate::source::Source;

pub use kept::PrintLayer;
pub(crate) use rounds::turns;
pub(crate) use staged::{Live, Stage, StageCache};

use print::Besides;

/// The slicer itself.
#[derive(Clone, Copy, Debug)]
pub struct Pipeline;

impl Pipeline {
    /// Writes a file in the order of the settings, without the proof, even if it is no improvement. Nothing is
    /// compared with what was there before, which [`Engine::reorder`] does: this is how the strategies themselves are
    /// measured.
    ///
    /// # Errors
    /// Where the file cannot be read, or the output not be written.
    pub fn rewrite(&self, file: &Path, settings: &Settings, output: &mut Output) -> Result<(), JobError> {
        let observer = Observer::none();
        reorder::rewritten(Source::File(file), settings, output, Workers { observer: &observer })
    }
}

impl Pipeline {
    /// Where the models of a job stand, and which objects (by their numbers on the plate) cannot be printed there.
    ///
    /// # Errors
    /// A model that cannot be read; models without positions that do not fit.
    pub fn placed(
        &self,
        job: &Job,
        settings: &Settings,
        observer: &Observer<'_>,
    ) -> Result<(Plate, Vec<(usize, PlacementError)>), JobError> {
        parallel::run(job.threads, observer, |workers| load::placed(job, settings, workers))
            .unwrap_or(Err(JobError::Cancelled))
    }

    /// A project as a file (3MF) that every slicer opens, with its models where they stand. [`Project::read`] gives it back to
    /// the bit. `job` and `settings` are what the project comes to.
    ///
    /// # Errors
    /// A model that cannot be transformed so.
    pub fn project_file(
        &self,
        project: &Project,
        files: &ModelFiles,
        job: &Job,
        settings: &Settings,
        observer: &Observer<'_>,
    ) -> Result<Vec<u8>, JobError> {
        parallel::run(job.threads, observer, |workers| project::write(project, files, job, settings, workers))
            .unwrap_or(Err(JobError::Cancelled))
    }
}

impl Pipeline {
    /// Slices models that have been read, and keeps the layers.
    pub(crate) fn slice_models(
        models: Vec<Model>,
        job: &Job,
        settings: &Settings,
        output: &mut Output,
        layers: &mut Vec<PrintLayer>,
        observer: &Observer<'_>,
    ) -> Result<Summary, JobError> {
        let besides = Besides { kept: Some(layers), ..Besides::default() };
        let slice = |workers: Workers<'_>| print::slice(models, job, settings, output, besides, workers);
        parallel::run(job.threads, observer, slice).unwrap_or(Err(JobError::Cancelled))
    }

    /// Slices a job, and hands on the moves of each layer.
    pub(crate) fn slice_moves(
        job: &Job,
        settings: &Settings,
        output: &mut Output,
        moves: impl FnMut(LayerMoves) + Send,
        observer: &Observer<'_>,
    ) -> Result<Summary, JobError> {
        let slice = |workers: Workers<'_>| {
            let besides = Besides { moves: Some(Box::new(moves)), ..Besides::default() };
            let models = load::read(job, settings, workers)?;
            print::slice(models, job, settings, output, besides, workers)
        };
        parallel::run(job.threads, observer, slice).unwrap_or(Err(JobError::Cancelled))
    }

    /// Slices a job, followed stage by stage.
    pub(crate) fn slice_live(
        job: &Job,
        settings: &Settings,
        output: &mut Output,
        live: Live<'_>,
        observer: &Observer<'_>,
    ) -> Result<Summary, JobError> {
        let slice = |workers: Workers<'_>| {
            let besides = Besides { live: Some(live), ..Besides::default() };
            let models = load::read(job, settings, workers)?;
            print::slice(models, job, settings, output, besides, workers)
        };
        parallel::run(job.threads, observer, slice).unwrap_or(Err(JobError::Cancelled))
    }

    /// Compares strategies on models that have been read.
    pub(crate) fn compare_models(
        models: Vec<Model>,
        job: &Job,
        settings: &Settings,
        strategies: &[OrderStrategy],
        observer: &Observer<'_>,
    ) -> Result<Vec<StrategyRow>, JobError> {
        let compare =
            |workers: Workers<'_>| compare::compare_models(models, job, settings, strategies, workers);
        parallel::run(job.threads, observer, compare).unwrap_or(Err(JobError::Cancelled))
    }

    /// Reorders G-code in memory.
    pub(crate) fn reorder_bytes(
        gcode: &[u8],
        job: &ReorderJob,
        settings: &Settings,
        output: &mut Output,
        observer: &Observer<'_>,
    ) -> Result<Reordered, JobError> {
        let reorder =
            |workers: Workers<'_>| reorder::reorder(Source::Memory(gcode), job, settings, output, workers);
        parallel::run(job.threads, observer, reorder).unwrap_or(Err(JobError::Cancelled))
    }
}

impl Engine for Pipeline {
    fn slice(
        &self,
        job: &Job,
        settings: &Settings,
        output: &mut Output,
        observer: &Observer<'_>,
    ) -> Result<Summary, JobError> {
        parallel::run(job.threads, observer, |workers| {
            let models = load::read(job, settings, workers)?;
            print::slice(models, job, settings, output, Besides::default(), workers)
        })
        .unwrap_or(Err(JobError::Cancelled))
    }

    fn compare(
        &self,
        job: &Job,
        settings: &Settings,
        strategies: &[OrderStrategy],
        observer: &Observer<'_>,
    ) -> Result<Vec<StrategyRow>, JobError> {
        parallel::run(job.threads, observer, |workers| compare::compare(job, settings, strategies, workers))
            .unwrap_or(Err(JobError::Cancelled))
    }

    fn compare_tools(
        &self,
        job: &Job,
        settings: &Settings,
        observer: &Observer<'_>,
    ) -> Result<Vec<ToolOrderRow>, JobError> {
        parallel::run(job.threads, observer, |workers| compare::compare_tools(job, settings, workers))
            .unwrap_or(Err(JobError::Cancelled))
    }

    fn paper(
        &self,
        job: &Job,
        settings: &Settings,
        observer: &Observer<'_>,
    ) -> Result<Vec<PaperRow>, JobError> {
        parallel::run(job.threads, observer, |workers| paper::paper(job, settings, workers))
            .unwrap_or(Err(JobError::Cancelled))
    }

    fn reorder(
        &self,
        job: &ReorderJob,
        settings: &Settings,
        output: &mut Output,
        observer: &Observer<'_>,
    ) -> Result<Reordered, JobError> {
        parallel::run(job.threads, observer, |workers| {
            reorder::reorder(Source::File(&job.file), job, settings, output, workers)
        })
        .unwrap_or(Err(JobError::Cancelled))
    }

    fn info(&self, job: &Job, settings: &Settings) -> Result<ModelInfo, JobError> {
        load::info(job, settings)
    }
}
