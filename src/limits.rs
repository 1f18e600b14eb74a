//! How much is too much. What goes beyond is refused before memory is taken for it.
//!
//! `docs/trust.md` lists these limits for users, with those of coordinates ([`crate::mesh`]) and settings.

use std::fs;

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

/// Whether there is so much memory.
///
/// # Errors
/// How much is needed, and how much there is.
pub fn room(need_bytes: u64) -> Result<(), String> {
    match available_bytes() {
        Some(free_bytes) if need_bytes > free_bytes => Err(format!(
            "about {} MB of memory are needed, {} MB are free",
            need_bytes >> 20,
            free_bytes >> 20
        )),
        _ => Ok(()),
    }
}

/// Memory that this process can still get, as far as the system tells: of the machine, of its control group, of its own
/// address space.
fn available_bytes() -> Option<u64> {
    let read = |path: &str| fs::read_to_string(path).ok();
    let machine = read("/proc/meminfo").and_then(|text| Some(field(&text, "MemAvailable:")? << 10));
    let number = |path: &str| read(path)?.trim().parse::<u64>().ok();
    let group = number("/sys/fs/cgroup/memory.max")
        .and_then(|most| Some(most.saturating_sub(number("/sys/fs/cgroup/memory.current")?)));
    let taken = read("/proc/self/status").and_then(|text| Some(field(&text, "VmSize:")? << 10));
    let own = read("/proc/self/limits")
        .and_then(|text| Some(field(&text, "Max address space")?.saturating_sub(taken?)));
    [machine, group, own].into_iter().flatten().min()
}

/// The number that follows a name at the beginning of a line.
fn field(text: &str, name: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    line.split_whitespace().next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_found_by_their_names() {
        let text = "MemTotal:  9 kB\nMemAvailable:   123 kB\nMax address space         unlimited  unlimited";
        assert_eq!((field(text, "MemAvailable:"), field(text, "Max address space")), (Some(123), None));
    }

    #[test]
    fn what_no_machine_has_is_refused() {
        assert!(room(0).is_ok());
        if available_bytes().is_some() {
            assert!(room(1 << 60).unwrap_err().contains("are needed"));
        }
    }
}
