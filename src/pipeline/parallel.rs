//! Parallel loops whose results do not depend on the number of threads.

use rayon::prelude::*;

/// Runs something with so many threads; `None`: as many as rayon chooses (`RAYON_NUM_THREADS`, or all cores).
pub(super) fn with_threads<T: Send>(threads: Option<usize>, run: impl FnOnce() -> T + Send) -> T {
    match threads.map(|n| rayon::ThreadPoolBuilder::new().num_threads(n).build()) {
        Some(Ok(pool)) => pool.install(run),
        // Without a pool of its own (the system has no threads to give) the work is done by the shared one.
        Some(Err(_)) | None => run(),
    }
}

/// The results of a function for 0, 1, … n − 1, in this order. Each is worth a task of its own: layers take very
/// different times.
pub(super) fn map<T: Send>(n: usize, f: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
    (0..n).into_par_iter().with_max_len(1).map(f).collect()
}

/// The results of two functions.
pub(super) fn join<A: Send, B: Send>(a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
    rayon::join(a, b)
}

/// Threads at work.
pub(super) fn threads() -> usize {
    rayon::current_num_threads()
}
