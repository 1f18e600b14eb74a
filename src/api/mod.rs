//! The library as most programs want it: models in memory, prints in memory.

mod finished;
mod model;
mod plate;
mod print;
mod slicer;

pub use finished::{check, check_against, reorder, time};
pub use model::Model;
pub use plate::Plate;
pub use print::Print;
pub use slicer::Slicer;
