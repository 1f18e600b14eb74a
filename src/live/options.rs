//! What a session needs, and how it can refuse.

use std::sync::Arc;
use std::time::Duration;

use crate::job::JobError;
use crate::presets::Library;

/// Does work beside the caller's own, now or later, most often `move |work| pool.spawn(work)`. The work calls no panics up.
pub type Spawn = Arc<dyn Fn(Box<dyn FnOnce() + Send>) + Send + Sync>;

/// What a session needs.
#[derive(Clone)]
pub struct Options {
    /// Slices are made with the threads of the pool that this work is done in.
    pub spawn: Spawn,
    /// The time since a fixed moment.
    pub clock: fn() -> Duration,
    /// Presets that projects may name.
    pub library: Option<Arc<Library>>,
    /// Most bytes of models: of their files and repaired meshes.
    pub models_bytes: usize,
    /// Most bytes of what is kept beside the newest results: those before, and what the next slicing can use.
    pub kept_bytes: usize,
}

/// Why something cannot be done.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Failure {
    /// A model or a project is wrong.
    #[error(transparent)]
    Job(#[from] JobError),
    /// There is no such model.
    #[error("there is no {what}")]
    Missing {
        /// What was asked for.
        what: String,
    },
    /// A limit of the session is reached.
    #[error("{0}")]
    Limit(String),
}
