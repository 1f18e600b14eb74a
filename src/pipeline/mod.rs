//! Wires the stages; the only user of rayon.
//!
//! Sections of all layers come first, since shells look at neighbours. Then layers flow in batches through
//! toolpaths, ordering, motion and formatting, each stage parallel over the layers (ordering: over chunks of
//! layers) and at work on a batch of its own, and their bytes are checked and go out in order.

mod compare;
mod floating;
mod infill;
mod inspect;
mod load;
mod ordering;
mod overlaps;
mod paper;
mod parallel;
mod print;
mod reorder;
mod rounds;
mod sections;
mod spiral;
mod styles;
mod supports;

use std::path::Path;

use crate::job::{Engine, Job, JobError, Progress, ReorderJob, TransformOptions};
use crate::order::OrderStrategy;
use crate::order::compare::StrategyRow;
use crate::output::Output;
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
        reorder::rewritten(file, settings, output)
    }
}

impl Engine for Pipeline {
    fn slice(
        &self,
        job: &Job,
        settings: &Settings,
        output: &mut Output,
        progress: &dyn Progress,
    ) -> Result<Summary, JobError> {
        parallel::with_threads(job.threads, || print::slice(job, settings, output, progress))
    }

    fn compare(
        &self,
        job: &Job,
        settings: &Settings,
        strategies: &[OrderStrategy],
        progress: &dyn Progress,
    ) -> Result<Vec<StrategyRow>, JobError> {
        parallel::with_threads(job.threads, || compare::compare(job, settings, strategies, progress))
    }

    fn paper(
        &self,
        job: &Job,
        settings: &Settings,
        progress: &dyn Progress,
    ) -> Result<Vec<PaperRow>, JobError> {
        parallel::with_threads(job.threads, || paper::paper(job, settings, progress))
    }

    fn reorder(
        &self,
        job: &ReorderJob,
        settings: &Settings,
        output: &mut Output,
        progress: &dyn Progress,
    ) -> Result<Reordered, JobError> {
        parallel::with_threads(job.threads, || reorder::reorder(job, settings, output, progress))
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
