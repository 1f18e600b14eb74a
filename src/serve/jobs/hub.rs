//! The jobs of a server: what is in memory, on the disk, and who waits for it.

use std::io;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

use tokio::sync::Semaphore;

use super::budget::Budget;
use super::files::{Files, GCODE};
use super::index::{Index, Turn};
use super::record::Work;
use super::render::{Picture, Renderer};
use super::store::{Changes, Store};
use crate::serve::error::ApiError;
use crate::serve::shared::Shared;
use crate::serve::tokens::now_s;

/// Uploads that are written at once; others wait for their turn.
const UPLOADS: usize = 32;

/// The jobs of a server.
#[derive(Debug)]
pub struct Jobs {
    /// Limits, presets, figures.
    pub shared: Arc<Shared>,
    /// Inputs and results.
    pub files: Files,
    /// Memory for runs and pictures.
    pub budget: Arc<Budget>,
    /// Pictures and pages of results.
    renderer: Renderer,
    /// Uploads that may be written.
    pub uploads: Arc<Semaphore>,
    store: Store,
    index: Mutex<Index>,
    /// Held from a change in memory until it is on the disk, so that both happen in one order.
    writing: Mutex<()>,
    /// There may be work.
    waiting: Condvar,
    stopping: AtomicBool,
}

impl Jobs {
    /// The jobs of a folder; those that did not end wait again.
    ///
    /// # Errors
    /// The folder cannot be used, or another server uses it.
    pub fn open(data: &Path, shared: Arc<Shared>) -> Result<Self, String> {
        let failed = |error: &dyn std::fmt::Display| format!("{}: {error}", data.display());
        let files = Files::open(data).map_err(|error| failed(&error))?;
        let (store, mut records) = Store::open(&data.join("jobs.redb")).map_err(|error| failed(&error))?;
        // Files are removed after their records; what is left of them is no result.
        records.results.retain(|(key, _)| files.result(key).join(GCODE).is_file());
        let mut changes = Changes::default();
        let index = Index::of(records, &shared.limits, now_s(), &mut changes);
        store.commit(&changes).map_err(|error| failed(&error))?;
        for live in index.works() {
            files.hold(&live.work.project);
            live.work.models.iter().for_each(|model| files.hold(&model.hash));
        }
        let is_input = |hash: &str| files.is_held(hash);
        files.sweep(is_input, |key| index.has_result(key)).map_err(|error| failed(&error))?;
        let jobs = Self {
            budget: Budget::new(shared.limits.memory_bytes),
            renderer: Renderer::default(),
            uploads: Arc::new(Semaphore::new(UPLOADS)),
            files,
            store,
            index: Mutex::new(index),
            writing: Mutex::default(),
            waiting: Condvar::new(),
            stopping: AtomicBool::new(false),
            shared,
        };
        jobs.gauge(&jobs.index());
        Ok(jobs)
    }

    /// What is in memory, for a moment.
    pub fn index(&self) -> MutexGuard<'_, Index> {
        self.index.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Changes something; when this returns it is on the disk. It blocks: not for threads that answer.
    ///
    /// # Errors
    /// That of the change; or the disk is full or broken.
    pub fn change<T>(
        &self,
        change: impl FnOnce(&mut Index, &mut Changes) -> Result<T, ApiError>,
    ) -> Result<T, ApiError> {
        let _writing = self.writing.lock().unwrap_or_else(PoisonError::into_inner);
        let mut changes = Changes::default();
        let done = {
            let mut index = self.index();
            let done = change(&mut index, &mut changes);
            self.gauge(&index);
            done
        };
        self.store.commit(&changes).map_err(ApiError::internal)?;
        done
    }

    fn gauge(&self, index: &Index) {
        let metrics = &self.shared.metrics;
        let (waiting, running) = index.counts();
        let number = |count: usize| i64::try_from(count).unwrap_or(i64::MAX);
        metrics.waiting.set(number(waiting));
        metrics.running.set(number(running));
        metrics.kept_bytes.set(i64::try_from(index.kept_bytes()).unwrap_or(i64::MAX));
    }

    /// There may be work.
    pub fn wake(&self) {
        // Whoever looked before this is waiting by now, and whoever looks after it sees what there is.
        drop(self.index());
        self.waiting.notify_all();
    }

    /// Waits for the next turn; `None`: the server ends.
    pub fn next(&self) -> Option<Turn> {
        loop {
            {
                let mut index = self.index();
                while index.counts().0 == 0 && !self.is_stopping() {
                    index = self.waiting.wait(index).unwrap_or_else(PoisonError::into_inner);
                }
            }
            if self.is_stopping() {
                return None;
            }
            let turn = self.change(|index, changes| Ok(index.next(changes)));
            match turn {
                Ok(Some(turn)) => return Some(turn),
                // Another was faster, or it was cancelled.
                Ok(None) => {}
                // Without a record of the attempt nothing is begun.
                Err(_) => std::thread::sleep(std::time::Duration::from_secs(1)),
            }
        }
    }

    /// Whether the server ends.
    pub fn is_stopping(&self) -> bool {
        self.stopping.load(Ordering::Relaxed)
    }

    /// Ends the runs: they are begun again after the next start.
    pub fn stop(&self) {
        self.stopping.store(true, Ordering::Relaxed);
        self.wake();
    }

    /// The inputs of a work are not needed any more.
    pub fn release(&self, work: &Work) {
        self.files.release(&work.project);
        work.models.iter().for_each(|model| self.files.release(&model.hash));
    }

    /// A picture of a result of so many bytes of G-code. It blocks.
    ///
    /// # Errors
    /// There is no such layer; the result went away meanwhile.
    pub fn picture(&self, result: (&str, u64), name: &str, picture: Picture) -> Result<Vec<u8>, ApiError> {
        let room = |bytes| self.budget.take(bytes, || !self.is_stopping());
        self.renderer.picture(&self.files, result, name, picture, room)
    }

    /// Does something that blocks, on a thread for such things.
    ///
    /// # Errors
    /// Its own; or it panicked.
    pub async fn blocking<T: Send + 'static>(
        self: &Arc<Self>,
        work: impl FnOnce(&Self) -> Result<T, ApiError> + Send + 'static,
    ) -> Result<T, ApiError> {
        let jobs = self.clone();
        tokio::task::spawn_blocking(move || work(&jobs)).await.map_err(ApiError::internal)?
    }
}

impl From<io::Error> for ApiError {
    fn from(error: io::Error) -> Self {
        Self::internal(format!("the disk of this server: {error}"))
    }
}
