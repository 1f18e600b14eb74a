//! The largest files, models and prints that are accepted.
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
/// Largest project, without its models.
pub const PROJECT_BYTES: u64 = 16 << 20;
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

/// Less memory than this is not asked for: whatever runs has it, and asking takes a while.
const ALWAYS_BYTES: u64 = 16 << 20;

/// By what the messages of [`check_memory`] are known.
pub(crate) const MEMORY_NEEDED: &str = "of memory are needed";

/// The function that says how much memory is free.
static MEMORY: OnceLock<fn() -> Option<u64>> = OnceLock::new();

/// Makes models and prints an error for which the free memory is too small. `free_bytes` gives the free memory, or `None`
/// if it is unknown. Only the first call counts.
pub fn watch_memory(free_bytes: fn() -> Option<u64>) {
    let _ = MEMORY.set(free_bytes);
}

/// Checks that this much memory is free, if it is more than any process has and [`watch_memory`] has been called.
///
/// # Errors
/// How much is needed, and how much there is.
pub fn check_memory(need_bytes: u64) -> Result<(), String> {
    let free_bytes = MEMORY.get().filter(|_| need_bytes >= ALWAYS_BYTES).and_then(|free_bytes| free_bytes());
    match free_bytes {
        Some(free_bytes) if need_bytes > free_bytes => {
            Err(format!("about {} MB {MEMORY_NEEDED}, {} MB are free", need_bytes >> 20, free_bytes >> 20))
        }
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
        assert!(check_memory(0).is_ok());
        assert!(check_memory(1 << 60).unwrap_err().contains("are needed"));
    }
}
