//! The library as most programs want it: models in memory, prints in memory.

mod beads;
mod finished;
mod model;
mod plate;
mod print;
mod slicer;

pub use beads::{Beads, SlicedJob};
pub use finished::{check, check_against, reorder, reorder_as, time};
pub use model::Model;
pub use plate::Plate;
pub use print::Print;
pub use slicer::Slicer;
