//! What this machine has: presets of its slicers, and memory (feature `host`).

pub mod memory;
mod places;
mod presets;

pub use presets::{NoPresets, all_presets, library, saved};
