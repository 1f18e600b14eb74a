//! What this machine has: presets of its slicers, and memory (feature `system`).

pub mod memory;
mod places;
mod presets;

#[cfg(feature = "send")]
pub use places::{HOSTS, hosts_file};
#[cfg(feature = "send")]
pub use presets::physical_printer;
pub use presets::{NoPresets, all_presets, library, saved};
