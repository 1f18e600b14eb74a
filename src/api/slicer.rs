//! Plates → prints.

use super::{Plate, Print};
use crate::job::{Job, JobError};
use crate::motion::PauseAt;
use crate::observer::Observer;
use crate::order::OrderStrategy;
use crate::order::compare::StrategyRow;
use crate::output::Output;
use crate::pipeline::Pipeline;
use crate::profile::{Settings, binary_metadata};

/// Slices plates.
///
/// # Examples
/// ```
/// use pathwright::{Mesh, Observer, Plate, Settings, Slicer};
///
/// let settings = Settings::load(&["petg"])?.set("infill.density", "15%")?;
/// let plate = Plate::new(&settings).add(Mesh::read("models/calibration_cube.stl")?)?;
/// let print = Slicer::new(&settings).slice(&plate, &Observer::none())?;
/// let mut file = Vec::new();
/// print.write_gcode(&mut file)?;
/// assert_eq!(print.summary().layer_count, print.layers().len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Slicer {
    settings: Settings,
    job: Job,
}

impl Slicer {
    /// A slicer that uses the threads that its caller has.
    pub fn new(settings: &Settings) -> Self {
        Self { settings: settings.clone(), job: Job::default() }
    }

    /// Starts this many threads for each run; 0: as many as the machine has cores. The result is the same.
    #[must_use]
    pub fn threads(mut self, threads: usize) -> Self {
        self.job.threads = Some(threads);
        self
    }

    /// Proves how near to the shortest possible the order is; see [`crate::report::Measures::bound_mm`].
    #[must_use]
    pub fn certified(mut self) -> Self {
        self.job.certify = true;
        self
    }

    /// Stops for a filament change.
    #[must_use]
    pub fn pause(mut self, at: PauseAt) -> Self {
        self.job.pauses.push(at);
        self
    }

    /// Prints also what begins in mid-air, instead of refusing it.
    #[must_use]
    pub fn allow_floating(mut self) -> Self {
        self.job.allow_floating = true;
        self
    }

    /// Slices a plate.
    ///
    /// # Errors
    /// The models do not fit the printer, there is nothing to print, something begins in mid-air, a script has a mistake,
    /// or the observer cancels the run: [`Error::Cancelled`](JobError::Cancelled).
    pub fn slice(&self, plate: &Plate, observer: &Observer<'_>) -> Result<Print, JobError> {
        let (mut output, mut layers) = (Output::memory(), Vec::new());
        let (job, settings) = (&self.job, &self.settings);
        let models = plate.models();
        let summary = Pipeline::slice_models(models, job, settings, &mut output, &mut layers, observer)?;
        Ok(Print { gcode: output.into_bytes(), metadata: binary_metadata(settings), summary, layers })
    }

    /// Orders the layers of a plate by each strategy, side by side.
    ///
    /// # Errors
    /// As [`Slicer::slice`].
    pub fn compare(
        &self,
        plate: &Plate,
        strategies: &[OrderStrategy],
        observer: &Observer<'_>,
    ) -> Result<Vec<StrategyRow>, JobError> {
        Pipeline::compare_models(plate.models(), &self.job, &self.settings, strategies, observer)
    }
}
