//! Wires the stages.
//!
//! Sections of all layers come first, since shells look at neighbours. Then layers flow in batches through
//! toolpaths, ordering, motion and formatting, each stage parallel over the layers (ordering: over chunks of
//! layers) and at work on a batch of its own, and their bytes are checked and go out in order.

mod compare;
mod inspect;
mod load;
mod ordering;
mod paper;
mod print;
mod reorder;
mod rounds;

use std::path::Path;

use crate::job::{Engine, Job, JobError, ReorderJob, TransformOptions};
use crate::observer::Observer;
use crate::order::OrderStrategy;
use crate::order::compare::StrategyRow;
use crate::output::Output;
use crate::parallel::{self, Workers};
use crate::profile::Settings;
use crate::report::{ModelInfo, PaperRow, Reordered, Summary};

/// The slicer itself.
#[derive(Clone, Copy, Debug)]
pub struct Pipeline;

impl Pipeline {
    /// Writes a file in the order that the settings ask for, whether or not that is any better. Nothing is compared
    /// with what was there before, which [`Engine::reorder`] does: this is how the strategies themselves are measured.
    ///
    /// # Errors
    /// Where the file cannot be read, or the output not be written.
    pub fn rewrite(&self, file: &Path, settings: &Settings, output: &mut Output) -> Result<(), JobError> {
        let observer = Observer::none();
        reorder::rewritten(&file.into(), settings, output, Workers { observer: &observer })
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
        parallel::run(job.threads, observer, |workers| print::slice(job, settings, output, workers))
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
            reorder::reorder(&job.file.as_path().into(), job, settings, output, workers)
        })
        .unwrap_or(Err(JobError::Cancelled))
    }

    fn info(
        &self,
        model: &Path,
        transform: &TransformOptions,
        settings: &Settings,
    ) -> Result<ModelInfo, JobError> {
        load::info(model, transform, settings)
    }
}
