//! Parallel loops whose results do not depend on the number of threads, and which end when a run is cancelled.
//!
//! Threads are used if the caller runs in a pool of rayon's; elsewhere everything is done by the calling thread, and no pool is
//! started.

mod cpus;

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

use rayon::prelude::*;
use rayon::{ThreadBuilder, ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};

use self::cpus::{Cpus, few, spread};
use crate::observer::Observer;

/// The panic payload of a cancelled run.
struct Cancelled;

/// The workers of one run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Workers<'a> {
    /// Who watches it.
    pub observer: &'a Observer<'a>,
}

impl Workers<'_> {
    /// The results of a function for 0, 1, … n − 1, in this order. Each is worth a task of its own: layers take very
    /// different times.
    pub fn map<T: Send>(self, n: usize, f: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
        let f = |i: usize| {
            self.go_on();
            f(i)
        };
        if in_pool() {
            (0..n).into_par_iter().with_max_len(1).map(f).collect()
        } else {
            (0..n).map(f).collect()
        }
    }

    /// Unwinds to [`run`] if the run is cancelled, without a message.
    pub fn go_on(self) {
        if self.observer.is_cancelled() {
            resume_unwind(Box::new(Cancelled));
        }
    }
}

/// The results of two functions.
pub(crate) fn join<A: Send, B: Send>(a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
    if in_pool() { rayon::join(a, b) } else { (a(), b()) }
}

/// Does something at some time, while others go on where there are several threads.
pub(crate) fn aside(work: impl FnOnce() + Send + 'static) {
    if threads() > 1 { rayon::spawn(work) } else { work() }
}

/// Threads at work.
pub(crate) fn threads() -> usize {
    if in_pool() { rayon::current_num_threads() } else { 1 }
}

/// WebAssembly without shared memory has one thread, and need not hold the code for more.
const HAS_THREADS: bool = !cfg!(all(target_family = "wasm", not(target_feature = "atomics")));

fn in_pool() -> bool {
    HAS_THREADS && rayon::current_thread_index().is_some()
}

/// Makes the calling thread, the only one of its process, one of so many (0: as many as `RAYON_NUM_THREADS` says, or else the
/// machine has cores) that work together from now on. Nothing happens where it is one of some already, or the system has no
/// threads to give.
#[cfg_attr(
    not(feature = "cli"),
    expect(dead_code, reason = "what else there is leaves threads to its caller")
)]
pub(crate) fn take_part(threads: usize) {
    if HAS_THREADS && !in_pool() {
        let is_open = threads == 0 && NUMBERS.iter().all(|name| std::env::var_os(name).is_none());
        let count = if is_open { few().unwrap_or(0) } else { threads };
        let builder = ThreadPoolBuilder::new().num_threads(count).use_current_thread();
        let Ok(pool) = builder.build() else { return };
        spread();
        ONE_OF.set(Some(threads));
        // They end with the program.
        std::mem::forget(pool);
    }
}

/// What rayon takes the number of threads from.
const NUMBERS: [&str; 2] = ["RAYON_NUM_THREADS", "RAYON_RS_NUM_CPUS"];

/// Starts workers on CPUs of their own, where they are before they do anything else: memory that they touch takes its time.
fn start(threads: usize) -> Result<ThreadPool, ThreadPoolBuildError> {
    let cpus = Arc::new(Cpus::default());
    let spawn = |worker: ThreadBuilder| {
        let cpus = cpus.clone();
        let begin = move || {
            cpus.begin();
            worker.run();
        };
        thread::Builder::new().spawn(begin).map(|_| ())
    };
    let pool = ThreadPoolBuilder::new().num_threads(threads).spawn_handler(spawn).build()?;
    // Those that are on this thread's CPU need it to leave it; to wake a thread that sleeps takes longer than they do.
    let until = Instant::now() + BEGINNING;
    while cpus.begun() < pool.current_num_threads() && Instant::now() < until {
        thread::yield_now();
    }
    cpus.keep_apart();
    Ok(pool)
}

/// How long is waited for threads to begin.
const BEGINNING: Duration = Duration::from_millis(1);

thread_local! {
    /// Of how many this thread is one, as [`take_part`] was told.
    static ONE_OF: Cell<Option<usize>> = const { Cell::new(None) };
}

/// Does something with a number of threads of its own (0: as many as `RAYON_NUM_THREADS` says, or else the machine has
/// cores), or with those that the caller is one of if it asked for as many; `None`: with those that the caller has. `None`
/// comes back if the observer cancels it.
pub(crate) fn run<T: Send>(
    threads: Option<usize>,
    observer: &Observer<'_>,
    work: impl FnOnce(Workers<'_>) -> T + Send,
) -> Option<T> {
    let work = || work(Workers { observer });
    let threads = threads.filter(|_| HAS_THREADS && threads != ONE_OF.get());
    let attempt = || match threads.map(start) {
        Some(Ok(pool)) => pool.install(work),
        // Where the system has no threads to give, the caller does the work.
        Some(Err(_)) | None => work(),
    };
    match catch_unwind(AssertUnwindSafe(attempt)) {
        Ok(done) => Some(done),
        Err(payload) if payload.is::<Cancelled>() => None,
        Err(payload) => resume_unwind(payload),
    }
}
