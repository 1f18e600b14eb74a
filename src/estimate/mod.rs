//! How long a layer takes: a look-ahead planner over its moves.
//!
//! It does what firmwares do: corners are taken at the speed that junction deviation allows, accelerations are
//! constant, and no speed is reached from which the machine could not stop in time.

mod cooling;
mod layer;
mod machine;
mod planner;

pub use cooling::cool;
pub use layer::{LayerTime, layer_time};
pub use machine::Machine;
pub use planner::{Planner, Segment, travel_time};
