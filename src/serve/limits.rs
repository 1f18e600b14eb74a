//! What one server does at most: every limit is an option, and every message names it.

use std::time::Duration;

/// The limits of a server. `docs/service.md` lists them with their options.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Largest request: models and project together, bytes.
    pub upload_bytes: u64,
    /// Most facets of all models of a job.
    pub facets: u64,
    /// Most jobs that wait, of all clients.
    pub waiting: usize,
    /// Most jobs of one client that wait or run.
    pub jobs_per_client: usize,
    /// Most bytes of models of one client whose jobs wait or run.
    pub bytes_per_client: u64,
    /// Longest time for a job, from its start.
    pub job_time: Duration,
    /// Most bytes that results take on the disk; the oldest go first.
    pub quota_bytes: u64,
    /// Most finished jobs that are remembered; the oldest are forgotten first.
    pub jobs_kept: usize,
    /// Most bytes of memory that slicing may be estimated to need, of all jobs that run.
    pub memory_bytes: u64,
    /// Most connections at once.
    pub connections: usize,
    /// Time for the head of a request, and between two requests.
    pub head_time: Duration,
    /// Time for a body of any size; beyond it a second more for every 16 KiB.
    pub body_time: Duration,
    /// Most event streams at once, of all clients.
    pub streams: usize,
    /// Most event streams of one client.
    pub streams_per_client: usize,
    /// Most sessions of pages at once.
    pub sessions: usize,
    /// How long a session without an event stream is kept.
    pub session_time: Duration,
    /// How often a job is begun again when the server died while it ran.
    pub attempts: u32,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            upload_bytes: 512 << 20,
            facets: 20_000_000,
            waiting: 1000,
            jobs_per_client: 200,
            bytes_per_client: 4 << 30,
            job_time: Duration::from_secs(1800),
            quota_bytes: 20 << 30,
            jobs_kept: 10_000,
            memory_bytes: 4 << 30,
            connections: 512,
            head_time: Duration::from_secs(15),
            body_time: Duration::from_secs(15),
            streams: 256,
            streams_per_client: 32,
            sessions: 16,
            session_time: Duration::from_secs(600),
            attempts: 5,
        }
    }
}

/// Bytes in the largest unit that divides them.
pub fn shown(bytes: u64) -> String {
    let units = [(1 << 30, "GiB"), (1 << 20, "MiB"), (1 << 10, "KiB")];
    let unit = units.into_iter().find(|(unit, _)| bytes >= *unit && bytes.is_multiple_of(*unit));
    unit.map_or_else(|| format!("{bytes} bytes"), |(unit, name)| format!("{} {name}", bytes / unit))
}
