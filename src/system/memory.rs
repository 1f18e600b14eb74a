//! Memory that this process can still get.

use std::fs;
use std::sync::atomic::{AtomicU64, Ordering};

/// The most that this process may have; 0: as much as there is.
static MOST: AtomicU64 = AtomicU64::new(0);

/// Sets the most that this process may have.
pub fn allow(bytes: u64) {
    MOST.store(bytes, Ordering::Relaxed);
}

/// Bytes of memory that this process has; `None`: the system does not tell.
pub fn used_bytes() -> Option<u64> {
    Some(field(&fs::read_to_string("/proc/self/status").ok()?, "VmRSS:")? << 10)
}

/// Free bytes as reported by the system: of the machine, of the control group, of the process's own address space.
pub fn available_bytes() -> Option<u64> {
    let read = |path: &str| fs::read_to_string(path).ok();
    let machine = read("/proc/meminfo").and_then(|text| Some(field(&text, "MemAvailable:")? << 10));
    let number = |path: &str| read(path)?.trim().parse::<u64>().ok();
    let group = number("/sys/fs/cgroup/memory.max")
        .and_then(|most| Some(most.saturating_sub(number("/sys/fs/cgroup/memory.current")?)));
    let taken = read("/proc/self/status").and_then(|text| Some(field(&text, "VmSize:")? << 10));
    let own = read("/proc/self/limits")
        .and_then(|text| Some(field(&text, "Max address space")?.saturating_sub(taken?)));
    let allowed = match MOST.load(Ordering::Relaxed) {
        0 => None,
        most => Some(most.saturating_sub(used_bytes().unwrap_or(0))),
    };
    [machine, group, own, allowed].into_iter().flatten().min()
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
}
