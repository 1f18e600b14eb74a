//! Results for people (text) and for programs (JSON).

mod measure;
mod model;
mod summary;

pub use measure::measure_layer;
pub use model::ModelInfo;
pub use summary::{LayerSummary, Measures, Summary};
