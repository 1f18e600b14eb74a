//! How long a host is waited for, and what is tried again.

use std::time::{Duration, Instant};

use super::error::SendError;

/// The first pause before something is tried again, and the longest.
const PAUSES: [Duration; 2] = [Duration::from_millis(250), Duration::from_secs(4)];
/// How long a host is waited for.
#[derive(Clone, Copy, Debug)]
pub struct Patience {
    /// How long broken connections and failing answers are tried again.
    pub retry: Duration,
    /// How long a host may be silent.
    pub silence: Duration,
    /// Is told of what is tried again.
    pub told: fn(&SendError),
}

impl Default for Patience {
    fn default() -> Self {
        Self { retry: Duration::from_secs(30), silence: Duration::from_secs(30), told: |_| {} }
    }
}

impl Patience {
    /// Does something until it succeeds, fails for good, or the patience is over.
    pub(super) fn with<T>(&self, mut work: impl FnMut() -> Result<T, SendError>) -> Result<T, SendError> {
        let begun = Instant::now();
        let [mut pause, longest] = PAUSES;
        loop {
            match work() {
                Err(error) if error.is_transient && begun.elapsed() + pause <= self.retry => {
                    (self.told)(&error);
                    std::thread::sleep(pause);
                    pause = (pause * 2).min(longest);
                }
                done => return done,
            }
        }
    }
}
