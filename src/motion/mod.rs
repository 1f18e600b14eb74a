//! Ordered paths → typed moves: travel, retraction, extrusion amounts, speeds.
//!
//! Each layer is planned by itself: it starts and ends un-retracted, and needs to know nothing of its
//! neighbours but where the one below ends ([`exit`]), so layers can be planned in any order and in parallel.

mod arc;
mod bead;
mod duration;
mod ends;
mod fan;
mod moves;
mod nozzle;
mod options;
mod overhang;
mod pause;
mod plan;
mod prime;
mod rules;
mod settings;
mod simplify;
mod smooth;
mod spiral;
mod sums;
mod swap;
mod swapping;
mod tool;
mod travel;

pub(crate) use duration::least_s;
pub use fan::set_fan;
pub use moves::{Entry, LayerMoves, Move, SwapStep, ToolChange};
pub use options::{
    AccelerationSettings, CoolingSettings, FilamentSettings, RetractSettings, RoleFlowSettings,
    SpeedSettings, TemperatureSettings, TravelSettings, filament_area_mm2,
};
pub use pause::{PauseAt, PauseError, Stop};
pub use plan::{exit, plan_layer};
pub use settings::{FlowSettings, MotionSettings};
pub(crate) use sums::arc_mm;
pub use sums::{LayerSums, ToolSums};
pub use swap::SwapSettings;
