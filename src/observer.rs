//! Observer of a run: receives progress and may cancel.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Duration;

/// Receives the progress of a run and can cancel it. Called from any thread.
///
/// # Examples
/// ```
/// use std::sync::atomic::AtomicBool;
/// use pathwright::Observer;
///
/// let stop = AtomicBool::new(false);
/// let observer = Observer::none().on_progress(|done, of| println!("{done} of {of} layers")).cancelled_by(&stop);
/// # let _ = observer;
/// ```
#[derive(Default)]
pub struct Observer<'a> {
    on_progress: Option<Box<dyn Fn(usize, usize) + Send + Sync + 'a>>,
    cancelled: Option<Arc<dyn Fn() -> bool + Send + Sync + 'a>>,
    clock: Option<fn() -> Duration>,
    done: AtomicUsize,
    total: AtomicUsize,
}

impl<'a> Observer<'a> {
    /// Nobody: the run is neither watched nor cancelled.
    pub fn none() -> Self {
        Self::default()
    }

    /// Calls a function with the layers that are done and all that there are, whenever that changes.
    #[must_use]
    pub fn on_progress(mut self, call: impl Fn(usize, usize) + Send + Sync + 'a) -> Self {
        self.on_progress = Some(Box::new(call));
        self
    }

    /// Ends the run with an error soon after a flag is set.
    #[must_use]
    pub fn cancelled_by(self, flag: &'a AtomicBool) -> Self {
        self.cancelled_when(|| flag.load(Ordering::Relaxed))
    }

    /// Ends the run with an error as soon as a function says so, which is asked before every piece of work.
    #[must_use]
    pub fn cancelled_when(mut self, call: impl Fn() -> bool + Send + Sync + 'a) -> Self {
        self.cancelled = Some(Arc::new(call));
        self
    }

    /// Sets a clock to measure the parts of a run: it gives the time since a fixed moment.
    #[must_use]
    pub fn timed_by(mut self, clock: fn() -> Duration) -> Self {
        self.clock = Some(clock);
        self
    }

    /// The same without reports of progress, for a part of a run.
    pub(crate) fn silent(&self) -> Observer<'a> {
        Observer { cancelled: self.cancelled.clone(), clock: self.clock, ..Observer::none() }
    }

    /// Number of layers.
    pub fn begin(&self, layers: usize) {
        self.total.store(layers, Ordering::Relaxed);
        self.done.store(0, Ordering::Relaxed);
        self.tell(0);
    }

    /// One more layer is done.
    pub fn layer_done(&self) {
        self.tell(self.done.fetch_add(1, Ordering::Relaxed) + 1);
    }

    /// Whether the run shall end.
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.as_ref().is_some_and(|call| call())
    }

    /// The time, where there is a clock.
    pub(crate) fn now(&self) -> Duration {
        self.clock.map_or(Duration::ZERO, |clock| clock())
    }

    fn tell(&self, done: usize) {
        if let Some(call) = &self.on_progress {
            call(done, self.total.load(Ordering::Relaxed));
        }
    }
}

impl fmt::Debug for Observer<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Observer")
            .field("done", &self.done)
            .field("total", &self.total)
            .finish_non_exhaustive()
    }
}
