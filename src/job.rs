//! The tasks of a run, and the errors that it can end with.

mod error;

use std::path::{Path, PathBuf};

use crate::motion::PauseAt;
use crate::observer::Observer;
use crate::order::OrderStrategy;
use crate::order::compare::StrategyRow;
use crate::output::Output;
use crate::profile::Settings;
use crate::report::{ModelInfo, PaperRow, Reordered, Summary};

pub use error::{CheckError, FitError, InputError, JobError};

/// Models for one plate, and what to do with them.
#[derive(Clone, Debug, PartialEq)]
pub struct Job {
    /// Files, in the order in which they are placed.
    pub models: Vec<PathBuf>,
    /// Support enforcers, placed as the first model is.
    pub support_enforcers: Vec<PathBuf>,
    /// Bodies, placed as the first model is, in which nothing is supported.
    pub support_blockers: Vec<PathBuf>,
    /// How each model is scaled, turned and moved.
    pub transform: TransformOptions,
    /// How many of each model; at least 1.
    pub copies: u32,
    /// Settings that some objects have of their own.
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

impl Default for Job {
    fn default() -> Self {
        Self {
            models: Vec::new(),
            support_enforcers: Vec::new(),
            support_blockers: Vec::new(),
            transform: TransformOptions::default(),
            copies: 1,
            objects: Vec::new(),
            pauses: Vec::new(),
            color_changes: Vec::new(),
            dated: None,
            allow_floating: false,
            certify: false,
            threads: None,
        }
    }
}

/// Settings of objects that differ from those of the plate.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectSettings {
    /// Name of the objects: a file, with or without folder or extension, or an object in a 3MF file.
    pub object: String,
    /// All settings; of use are those of [`ObjectSettings::SECTIONS`].
    pub settings: Settings,
}

impl ObjectSettings {
    /// Sections that may differ from object to object.
    pub const SECTIONS: [&str; 5] = ["walls", "shell", "infill", "ironing", "bridge"];
}

/// Scaled first, then turned, then placed on the bed, then moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransformOptions {
    /// Factors along X, Y and Z; greater than 0.
    pub scale: [f64; 3],
    /// Angles about X, Y and Z, in this order, degrees.
    pub rotate_deg: [f64; 3],
    /// Away from where the model would be placed, millimetres.
    pub translate_mm: [f64; 3],
    /// Shrink what is larger than the bed.
    pub scale_to_fit: bool,
}

impl Default for TransformOptions {
    fn default() -> Self {
        Self { scale: [1.0; 3], rotate_deg: [0.0; 3], translate_mm: [0.0; 3], scale_to_fit: false }
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

    /// Reports the contents of a model, and whether it fits.
    ///
    /// # Errors
    /// [`JobError::Input`] if it cannot be read.
    fn info(
        &self,
        model: &Path,
        transform: &TransformOptions,
        settings: &Settings,
    ) -> Result<ModelInfo, JobError>;
}
