//! Memory that work is estimated to need: what has no room waits.

use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Duration;

/// Memory that is shared by whoever needs much.
#[derive(Debug)]
pub struct Budget {
    all_bytes: u64,
    free_bytes: Mutex<u64>,
    freed: Condvar,
}

/// A share of it, given back when this is dropped.
#[derive(Debug)]
pub struct Share {
    budget: Arc<Budget>,
    bytes: u64,
}

impl Budget {
    /// This much for all together.
    pub fn new(all_bytes: u64) -> Arc<Self> {
        Arc::new(Self { all_bytes, free_bytes: Mutex::new(all_bytes), freed: Condvar::new() })
    }

    /// All that there is.
    pub fn all_bytes(&self) -> u64 {
        self.all_bytes
    }

    /// Takes a share when there is room for it; whoever needs more than there is takes all. `None`: it is not wanted any more.
    pub fn take(self: &Arc<Self>, bytes: u64, is_wanted: impl Fn() -> bool) -> Option<Share> {
        const LOOK: Duration = Duration::from_millis(200);
        let bytes = bytes.min(self.all_bytes);
        let mut free = self.free_bytes.lock().unwrap_or_else(PoisonError::into_inner);
        while *free < bytes {
            if !is_wanted() {
                return None;
            }
            free = self.freed.wait_timeout(free, LOOK).unwrap_or_else(PoisonError::into_inner).0;
        }
        *free -= bytes;
        Some(Share { budget: self.clone(), bytes })
    }
}

impl Drop for Share {
    fn drop(&mut self) {
        *self.budget.free_bytes.lock().unwrap_or_else(PoisonError::into_inner) += self.bytes;
        self.budget.freed.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_has_no_room_waits_until_it_has() {
        let budget = Budget::new(10);
        let first = budget.take(6, || true).unwrap();
        assert!(budget.take(6, || false).is_none());
        drop(first);
        assert!(budget.take(99, || false).is_some(), "more than there is: all");
    }
}
