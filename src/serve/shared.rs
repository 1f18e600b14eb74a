//! What all parts of the service use.

use std::path::PathBuf;
use std::sync::Arc;

use rayon::{ThreadPool, ThreadPoolBuilder};
use tokio::sync::watch;

use super::limits::Limits;
use super::metrics::Metrics;
use super::streams::Streams;
use super::tokens::Tokens;
use crate::presets::{Library, Printers};

/// What all parts of the service use.
#[derive(Debug)]
pub struct Shared {
    /// What the server does at most.
    pub limits: Limits,
    /// Who may use it.
    pub tokens: Tokens,
    /// Its names, besides addresses.
    pub hosts: Vec<String>,
    /// Whether it encrypts by itself.
    pub tls: bool,
    /// Presets of other slicers.
    pub presets: Arc<Library>,
    /// The printers among them, once they were asked for.
    pub printers: Printers,
    /// Threads for what pages do: they are not those that answer.
    pub slicing: Arc<ThreadPool>,
    /// Event streams that are open.
    pub streams: Arc<Streams>,
    /// Figures for Prometheus.
    pub metrics: Metrics,
    /// The file of print hosts that the page may send to.
    pub print_hosts: Option<PathBuf>,
    /// Models that the page opens at its start.
    pub opened: Vec<(String, Vec<u8>)>,
    /// True when the server is going to end: streams shall end, too.
    pub ending: watch::Receiver<bool>,
}

impl Shared {
    /// Does something with the threads that slice, without keeping those that answer from it. A panic comes back as `None`.
    pub async fn in_pool<T: Send + 'static>(&self, work: impl FnOnce() -> T + Send + 'static) -> Option<T> {
        let (done, result) = tokio::sync::oneshot::channel();
        self.slicing.spawn(move || {
            let outcome = std::panic::catch_unwind(std::panic::AssertUnwindSafe(work));
            // Who asked may be gone.
            let _ = done.send(outcome.ok());
        });
        result.await.ok().flatten()
    }
}

/// Threads that slice; 0: as many as the machine has cores.
pub fn pool(threads: usize, name: &'static str) -> std::io::Result<ThreadPool> {
    ThreadPoolBuilder::new()
        .num_threads(threads)
        .thread_name(move |index| format!("{name}-{index}"))
        .build()
        .map_err(std::io::Error::other)
}
