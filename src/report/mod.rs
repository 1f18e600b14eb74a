//! Results for people (text) and for programs (JSON).

mod model;
mod summary;

pub use model::ModelInfo;
pub use summary::{LayerSummary, Measures, Summary};
