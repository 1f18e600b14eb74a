//! Results for people (text) and for programs (JSON).

mod model;
pub mod paper;
mod reordered;
mod repairs;
mod summary;
mod time;

pub use model::ModelInfo;
pub use paper::PaperRow;
pub use reordered::{PathMeasures, Reordered};
pub use repairs::Repaired;
pub use summary::{LayerSummary, Measures, Overhangs, Summary, TimeBound, ToolSummary};
pub use time::{LayerTime, PrintTime, Seconds};
