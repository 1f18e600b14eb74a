//! What is printed in one go.

use super::Model;
use crate::job::JobError;
use crate::plate;
use crate::profile::Settings;

/// Models that are printed together; they are arranged when the plate is sliced.
///
/// # Examples
/// ```
/// use pathwright::{Mesh, Model, Plate, Settings};
///
/// let settings = Settings::load(&["petg"])?;
/// let plate = Plate::new(&settings)
///     .add(Mesh::read("models/calibration_cube.stl")?)?
///     .add(Model::read("models/tilted_bracket.3mf")?.copies(2))?;
/// # let _ = plate;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Plate {
    settings: Settings,
    models: Vec<plate::Model>,
}

impl Plate {
    /// An empty plate.
    pub fn new(settings: &Settings) -> Self {
        Self { settings: settings.clone(), models: Vec::new() }
    }

    /// Adds a model.
    ///
    /// # Errors
    /// A scale or rotation that leaves nothing, or makes it longer than 10 m.
    #[allow(clippy::should_implement_trait, reason = "a plate plus a model is no sum")]
    pub fn add(mut self, model: impl Into<Model>) -> Result<Self, JobError> {
        let model = model.into().prepared(&self.settings)?;
        self.models.push(model);
        Ok(self)
    }

    pub(super) fn models(&self) -> Vec<plate::Model> {
        self.models.clone()
    }
}
