//! How long a host is waited for, and what is tried again.

use std::time::Duration;

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
    /// The time since a fixed moment.
    pub clock: fn() -> Duration,
    /// Waits.
    pub pause: fn(Duration),
}

#[cfg(feature = "send")]
impl Default for Patience {
    fn default() -> Self {
        static BEGUN: std::sync::LazyLock<std::time::Instant> =
            std::sync::LazyLock::new(std::time::Instant::now);
        Self {
            retry: Duration::from_secs(30),
            silence: Duration::from_secs(30),
            told: |_| {},
            clock: || BEGUN.elapsed(),
            pause: std::thread::sleep,
        }
    }
}

impl Patience {
    /// Does something until it succeeds, fails for good, or the patience is over.
    pub(super) fn with<T>(&self, mut work: impl FnMut() -> Result<T, SendError>) -> Result<T, SendError> {
        let begun = (self.clock)();
        let [mut pause, longest] = PAUSES;
        loop {
            match work() {
                Err(error) if error.is_transient && (self.clock)() + pause <= begun + self.retry => {
                    (self.told)(&error);
                    (self.pause)(pause);
                    pause = (pause * 2).min(longest);
                }
                done => return done,
            }
        }
    }
}
