//! Work in a thread of its own, while the caller's looks after Python: signals, progress.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, OnceLock};
use std::thread;
use std::time::{Duration, Instant};

use pathwright::Observer;
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;

/// How often signals are looked at and progress is told.
const EVERY: Duration = Duration::from_millis(10);
/// How long a run that is cancelled is waited for. One that cannot stop so soon ends by itself, unseen.
const GRACE: Duration = Duration::from_millis(40);
/// Virtual; as much as the main thread of a program has.
const STACK_BYTES: usize = 8 << 20;

#[derive(Default)]
struct State {
    stop: AtomicBool,
    done: AtomicUsize,
    total: AtomicUsize,
}

/// Does something while other Python threads go on. `progress` is called in the thread of the caller with what is done and all
/// that there is. A signal, or an error of `progress`, cancels the work.
pub fn run<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Observer<'_>) -> T + Send + 'static,
) -> PyResult<T> {
    let state = Arc::new(State::default());
    let (sender, mut receiver) = mpsc::channel();
    let shared = Arc::clone(&state);
    let job = move || {
        let tell = |done, total| {
            shared.total.store(total, Ordering::Relaxed);
            shared.done.store(done, Ordering::Release);
        };
        let observer = Observer::none().on_progress(tell).cancelled_by(&shared.stop).timed_by(clock);
        let result = catch_unwind(AssertUnwindSafe(|| work(&observer)));
        // Nobody waits any more for what was cancelled.
        let _ = sender.send(result);
    };
    thread::Builder::new()
        .name("pathwright".into())
        .stack_size(STACK_BYTES)
        .spawn(job)
        .map_err(|error| PyOSError::new_err(format!("no thread can be started: {error}")))?;
    let mut told = (0, 0);
    loop {
        let message;
        (message, receiver) = py.detach(move || (receiver.recv_timeout(EVERY), receiver));
        let current = (state.done.load(Ordering::Acquire), state.total.load(Ordering::Relaxed));
        let mut looked = py.check_signals();
        if let (Ok(()), Some(progress)) = (&looked, progress)
            && current.1 > 0
            && current != told
        {
            told = current;
            looked = progress.call1(current).map(|_| ());
        }
        match message {
            // What is done is done: a signal is for what comes next.
            Ok(Ok(result)) => return looked.map(|()| result),
            Ok(Err(panic)) => resume_unwind(panic),
            Err(RecvTimeoutError::Disconnected) => unreachable!("it always sends a result"),
            Err(RecvTimeoutError::Timeout) => {}
        }
        if let Err(error) = looked {
            state.stop.store(true, Ordering::Relaxed);
            py.detach(move || {
                let _ = receiver.recv_timeout(GRACE);
            });
            return Err(error);
        }
    }
}

/// Unwinds to [`run`], which expects it, if the work is cancelled.
pub fn go_on(observer: &Observer<'_>) {
    if observer.is_cancelled() {
        resume_unwind(Box::new("cancelled"));
    }
}

/// Time since the first call.
fn clock() -> Duration {
    static BEGUN: OnceLock<Instant> = OnceLock::new();
    BEGUN.get_or_init(Instant::now).elapsed()
}
