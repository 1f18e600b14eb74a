//! How much is too much. What goes beyond is refused.
//!
//! `docs/trust.md` lists these limits for users, with those of coordinates ([`crate::mesh`]) and settings.

use std::sync::OnceLock;

/// Largest model file.
pub const MODEL_BYTES: u64 = 4 << 30;
/// Most facets of a model: corners are numbered in 32 bits, three for each facet.
pub const FACETS: usize = 80_000_000;
/// Most layers of a print.
pub const LAYERS: usize = 100_000;
/// Most triangles crossed by all layers together: they are numbered in 32 bits.
pub const CROSSINGS: u64 = 2_000_000_000;
/// Largest profile.
pub const PROFILE_BYTES: u64 = 1 << 20;
/// Largest file of presets of another slicer.
pub const PRESETS_BYTES: u64 = 64 << 20;
/// Most profiles that inherit from each other in a row.
pub const PROFILE_DEPTH: usize = 32;
/// Most problems of one set of settings that are listed.
pub const PROFILE_PROBLEMS: usize = 100;
/// Most profiles read for one set of settings.
pub const PROFILES: usize = 1_000;
/// Largest G-code file that is held in memory as a whole, to be viewed. Other commands read files of any size.
pub const VIEW_BYTES: u64 = 2 << 30;

/// Bytes that a model needs for each of its file, from reading to repair (measured: 130 for the 50 of a binary facet).
pub const BYTES_PER_BYTE: u64 = 3;
/// Bytes that a print needs for each triangle that a layer crosses: outlines, shells, paths (measured: below 60).
pub const BYTES_PER_CROSSING: u64 = 64;

/// Who knows how much memory is free.
static MEMORY: OnceLock<fn() -> Option<u64>> = OnceLock::new();

/// Has models and prints refused for which the memory that is free would not do. `free_bytes` is asked for it, and knows it
/// or not. The first caller decides.
pub fn watch_memory(free_bytes: fn() -> Option<u64>) {
    let _ = MEMORY.set(free_bytes);
}

/// Whether there is so much memory, where somebody knows how much is free.
///
/// # Errors
/// How much is needed, and how much there is.
pub fn room(need_bytes: u64) -> Result<(), String> {
    match MEMORY.get().and_then(|free_bytes| free_bytes()) {
        Some(free_bytes) if need_bytes > free_bytes => Err(format!(
            "about {} MB of memory are needed, {} MB are free",
            need_bytes >> 20,
            free_bytes >> 20
        )),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_no_machine_has_is_refused() {
        // So much is free that no other test of this program is refused anything.
        watch_memory(|| Some(1 << 50));
        assert!(room(0).is_ok());
        assert!(room(1 << 60).unwrap_err().contains("are needed"));
    }
}
