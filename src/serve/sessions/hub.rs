//! The sessions there are.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::{Duration, Instant};

use crate::live::{Failure, Options, Session};
use crate::serve::error::{ApiError, ErrorKind};
use crate::serve::names::unguessable;
use crate::serve::shared::Shared;
use crate::serve::tokens::Client;

/// A session has at most this share of the memory for its models, and as much for what is kept between slicings.
const SHARE: u64 = 4;

/// The sessions there are.
pub struct Hub {
    pub shared: Arc<Shared>,
    sessions: Mutex<HashMap<String, Arc<Entry>>>,
}

/// A session of a client.
pub struct Entry {
    pub session: Session,
    client: Client,
    watch: Mutex<Watch>,
}

/// Who looks at a session.
struct Watch {
    streams: usize,
    /// When it was used last.
    used: Instant,
    /// The revisions that are compared.
    compared: Option<[u64; 2]>,
}

/// A stream of a session; it counts until this is dropped.
pub struct Watching(Arc<Entry>);

impl Hub {
    /// No session yet.
    pub fn new(shared: Arc<Shared>) -> Arc<Self> {
        Arc::new(Self { shared, sessions: Mutex::default() })
    }

    fn sessions(&self) -> MutexGuard<'_, HashMap<String, Arc<Entry>>> {
        self.sessions.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Begins a session. Its name.
    ///
    /// # Errors
    /// There are too many.
    pub fn open(self: &Arc<Self>, client: Client) -> Result<String, ApiError> {
        let limits = &self.shared.limits;
        let name = unguessable()?;
        let pool = self.shared.slicing.clone();
        let share = usize::try_from(limits.memory_bytes / SHARE).unwrap_or(usize::MAX);
        let session = Session::new(Options {
            spawn: Arc::new(move |work| pool.spawn(work)),
            clock,
            library: Some(self.shared.presets.clone()),
            models_bytes: share,
            kept_bytes: share,
        });
        let watch = Mutex::new(Watch { streams: 0, used: Instant::now(), compared: None });
        let mut sessions = self.sessions();
        if sessions.len() >= limits.sessions {
            let most = limits.sessions;
            let message = format!("{most} pages are open, which is the most (--max-sessions); close one");
            return Err(ApiError::busy(message));
        }
        sessions.insert(name.clone(), Arc::new(Entry { session, client, watch }));
        drop(sessions);
        tokio::spawn(expire(Arc::downgrade(self), name.clone(), limits.session_time));
        Ok(name)
    }

    /// A client's session; it counts as used.
    ///
    /// # Errors
    /// There is none, or it is another's.
    pub fn find(&self, name: &str, client: &Client) -> Result<Arc<Entry>, ApiError> {
        let found = self.sessions().get(name).filter(|entry| entry.client == *client).cloned();
        let entry = found.ok_or_else(|| ApiError::not_found("there is no such session; begin another"))?;
        entry.watch().used = Instant::now();
        Ok(entry)
    }

    /// Ends a session.
    pub fn close(&self, name: &str) {
        let entry = self.sessions().remove(name);
        if let Some(entry) = entry {
            entry.session.close();
        }
    }
}

impl Hub {
    /// Does something that takes a while with the threads that slice.
    pub async fn work<T: Send + 'static>(
        &self,
        work: impl FnOnce() -> Result<T, Failure> + Send + 'static,
    ) -> Result<T, ApiError> {
        let done = self.shared.in_pool(work).await;
        Ok(done.ok_or_else(|| ApiError::internal("a mistake of this program; the session goes on"))??)
    }
}

/// Ends a session that nobody looked at for a while.
async fn expire(hub: std::sync::Weak<Hub>, name: String, after: Duration) {
    loop {
        let Some(left) = hub.upgrade().and_then(|hub| {
            let entry = hub.sessions().get(&name).cloned()?;
            let watch = entry.watch();
            match watch.streams {
                0 => Some(after.saturating_sub(watch.used.elapsed())),
                _ => Some(after),
            }
        }) else {
            return;
        };
        if left.is_zero() {
            if let Some(hub) = hub.upgrade() {
                hub.close(&name);
            }
            return;
        }
        tokio::time::sleep(left).await;
    }
}

impl Entry {
    fn watch(&self) -> MutexGuard<'_, Watch> {
        self.watch.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Counts a stream.
    pub fn watching(self: &Arc<Self>) -> Watching {
        self.watch().streams += 1;
        Watching(self.clone())
    }

    /// The revisions that are compared, if any are.
    pub fn compared(&self) -> Option<[u64; 2]> {
        self.watch().compared
    }

    /// Takes note of them.
    pub fn compare(&self, revisions: Option<[u64; 2]>) {
        self.watch().compared = revisions;
    }
}

impl Watching {
    /// The session.
    pub fn entry(&self) -> &Arc<Entry> {
        &self.0
    }
}

impl Drop for Watching {
    fn drop(&mut self) {
        let mut watch = self.0.watch();
        watch.streams -= 1;
        watch.used = Instant::now();
    }
}

/// The time since the first question.
fn clock() -> Duration {
    static BEGUN: OnceLock<Instant> = OnceLock::new();
    BEGUN.get_or_init(Instant::now).elapsed()
}

impl From<Failure> for ApiError {
    fn from(failure: Failure) -> Self {
        match failure {
            Failure::Job(error) => error.into(),
            Failure::Missing { .. } => Self::not_found(failure),
            Failure::Limit(message) => Self::unusable(ErrorKind::Limit, message),
        }
    }
}
