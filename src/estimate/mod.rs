//! How long a layer takes: a look-ahead planner over its moves.
//!
//! It does what [firmwares](Firmware) do: corners are taken as fast as theirs take them, accelerations are constant, and
//! no speed is reached from which the machine could not stop in time. Heating and homing take no time.

mod chords;
mod cooling;
mod corner;
mod layer;
mod machine;
mod options;
mod planner;

pub(crate) use chords::chords;
pub use cooling::cool;
pub use layer::{LayerTime, layer_time, move_times_s};
pub use machine::{Firmware, FirmwareRetraction, Machine};
pub use options::MachineSettings;
pub use planner::{Planner, Segment, travel_time};
