//! What a run is asked to do, how it tells how far it is, and how it can fail.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use crate::output::{Output, OutputError};
use crate::profile::{ProfileError, Settings};
use crate::report::{ModelInfo, Summary};

/// Models for one plate, and what to do with them.
#[derive(Clone, Debug, PartialEq)]
pub struct Job {
    /// Files, in the order in which they are placed.
    pub models: Vec<PathBuf>,
    /// How each model is scaled, turned and moved.
    pub transform: TransformOptions,
    /// How many of each model; at least 1.
    pub copies: u32,
    /// Where the print stops for a filament change.
    pub pauses: Vec<PauseAt>,
    /// Prove how near to the shortest possible the order is.
    pub certify: bool,
    /// Worker threads; `None`: `RAYON_NUM_THREADS`, or else all cores.
    pub threads: Option<usize>,
}

impl Default for Job {
    fn default() -> Self {
        Self {
            models: Vec::new(),
            transform: TransformOptions::default(),
            copies: 1,
            pauses: Vec::new(),
            certify: false,
            threads: None,
        }
    }
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

/// Where to pause: `12` is before the twelfth layer, `12.4mm` before the first layer that ends above that height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PauseAt {
    /// A layer, counted from 0.
    Layer(usize),
    /// A height over the bed, millimetres.
    Height(f64),
}

impl FromStr for PauseAt {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || "a layer such as 12, or a height such as 12.4mm, is expected".to_owned();
        match text.strip_suffix("mm") {
            Some(number) => match number.trim().parse::<f64>() {
                Ok(height) if height.is_finite() && height > 0.0 => Ok(Self::Height(height)),
                _ => Err(wrong()),
            },
            None => match text.parse::<usize>() {
                Ok(layer) if layer > 0 => Ok(Self::Layer(layer - 1)),
                _ => Err(wrong()),
            },
        }
    }
}

/// Is told how far a run is. Called from any thread.
pub trait Progress: Sync {
    /// So many layers there are.
    fn begin(&self, layers: usize);
    /// One more layer has been written.
    fn layer_done(&self);
}

/// Tells nobody.
#[derive(Clone, Copy, Debug)]
pub struct Silent;

impl Progress for Silent {
    fn begin(&self, _layers: usize) {}
    fn layer_done(&self) {}
}

/// Why a run gave no result. Each message holds the place and the mend.
#[derive(Debug, thiserror::Error)]
pub enum JobError {
    /// A model is unreadable or holds nothing to print.
    #[error("{0}")]
    Input(String),
    /// Settings that this job cannot be done with.
    #[error(transparent)]
    Settings(#[from] ProfileError),
    /// The models do not fit the printer.
    #[error("{0}")]
    DoesNotFit(String),
    /// The G-code cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The result failed a check of its own; nothing is written.
    #[error("{0}")]
    Check(String),
}

/// What does the work for the command line.
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
        progress: &dyn Progress,
    ) -> Result<Summary, JobError>;

    /// Tells what is in a model, and whether it fits.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pause_is_a_layer_or_a_height() {
        assert_eq!("12".parse(), Ok(PauseAt::Layer(11)));
        assert_eq!("12.4mm".parse(), Ok(PauseAt::Height(12.4)));
        for wrong in ["0", "-1", "12.4", "mm", "nanmm", "0mm", "x"] {
            assert!(wrong.parse::<PauseAt>().is_err(), "{wrong}");
        }
    }
}
