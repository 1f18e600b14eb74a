//! All jobs in memory: who waits, whose turn it is, what is there. Whatever changes is written down for the store.

use std::collections::HashMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use tokio::sync::watch;

use super::record::{Job, JobView, Kept, Outcome, Progress, State, Work};
use super::store::{Changes, Records};
use crate::serve::error::{ApiError, ErrorKind, Problem};
use crate::serve::limits::{Limits, shown};

/// A work that waits or runs.
#[derive(Debug)]
pub struct Live {
    /// As it is stored.
    pub work: Work,
    /// Jobs that it is for.
    pub jobs: Vec<String>,
    /// Whether it is being sliced.
    pub is_running: bool,
    /// What those who watch it share.
    pub signs: Arc<Signs>,
}

/// What the run of a work and those who watch it share.
#[derive(Debug)]
pub struct Signs {
    /// Nobody wants it any more.
    pub cancelled: AtomicBool,
    done: AtomicUsize,
    of: AtomicUsize,
    changed: watch::Sender<()>,
}

impl Default for Signs {
    fn default() -> Self {
        Self {
            cancelled: AtomicBool::new(false),
            done: AtomicUsize::new(0),
            of: AtomicUsize::new(0),
            changed: watch::Sender::new(()),
        }
    }
}

impl Signs {
    /// Layers that are done.
    pub fn set_progress(&self, done: usize, of: usize) {
        self.of.store(of, Ordering::Relaxed);
        self.done.store(done, Ordering::Relaxed);
        self.tell();
    }

    /// Something has changed.
    pub fn tell(&self) {
        self.changed.send_replace(());
    }

    /// Wakes up when something changes.
    pub fn watch(&self) -> watch::Receiver<()> {
        self.changed.subscribe()
    }

    fn progress(&self) -> Progress {
        Progress { done: self.done.load(Ordering::Relaxed), of: self.of.load(Ordering::Relaxed) }
    }
}

/// A job that shall be accepted.
#[derive(Debug)]
pub struct Offer {
    /// By which it will be asked for.
    pub id: String,
    /// The job, its position left open.
    pub job: Job,
    /// What is to be done for it, its position left open.
    pub work: Work,
}

/// What became of an offer.
#[derive(Debug, PartialEq, Eq)]
pub enum Accepted {
    /// The result is there: nothing is to be done.
    Known,
    /// Another job waits for the same result: nothing more is to be done.
    Joined,
    /// It waits for its turn; its inputs are needed.
    New,
    /// The client has sent it before, as the job of this id.
    Repeated(String),
}

/// A work whose turn it is.
#[derive(Debug)]
pub struct Turn {
    /// Key of the result.
    pub key: String,
    /// What is to be done.
    pub work: Work,
    /// What is shared with those who watch it.
    pub signs: Arc<Signs>,
}

/// All jobs.
#[derive(Debug, Default)]
pub struct Index {
    jobs: HashMap<String, Job>,
    works: HashMap<String, Live>,
    results: HashMap<String, Kept>,
    /// Jobs by client and the key that it gave to them.
    named: HashMap<(String, String), String>,
    /// When each client had its last turn.
    served: HashMap<String, u64>,
    /// Counts what happens.
    clock: u64,
}

impl Index {
    /// As the store has it. What ran waits again; `limits` says how often.
    pub fn of(records: Records, limits: &Limits, now_s: u64, changes: &mut Changes) -> Self {
        let mut index = Self { results: records.results.into_iter().collect(), ..Self::default() };
        for (key, work) in records.works {
            index.clock = index.clock.max(work.seq);
            let live = Live { work, jobs: Vec::new(), is_running: false, signs: Arc::default() };
            index.works.insert(key, live);
        }
        for (id, mut job) in records.jobs {
            index.clock = index.clock.max(job.seq);
            if job.outcome.is_none() {
                match index.works.get_mut(&job.key) {
                    Some(live) => live.jobs.push(id.clone()),
                    // Its work ended, and this was not written: it cannot be, as both are written together.
                    None => job.outcome = Some(Outcome::Cancelled),
                }
            }
            index.insert(id, job);
        }
        index.clock = index.results.values().map(|kept| kept.used).fold(index.clock, u64::max);
        let dead = index.works.iter().filter(|(_, live)| live.work.attempts >= limits.attempts);
        let dead: Vec<(String, u32)> = dead.map(|(key, live)| (key.clone(), live.work.attempts)).collect();
        for (key, attempts) in dead {
            let message = format!(
                "the server died {attempts} times while this was sliced, and does not try again (--max-attempts)"
            );
            let problem = Problem { kind: ErrorKind::Limit, message, object: None, key: None };
            index.finish(&key, Outcome::Failed(problem), None, now_s, changes);
        }
        let orphans = index.works.iter().filter(|(_, live)| live.jobs.is_empty()).map(|(key, _)| key.clone());
        for key in orphans.collect::<Vec<_>>() {
            index.works.remove(&key);
            changes.no_work(&key);
        }
        index
    }

    fn insert(&mut self, id: String, job: Job) {
        if let Some(name) = &job.idempotency_key {
            self.named.insert((job.client.clone(), name.clone()), id.clone());
        }
        self.jobs.insert(id, job);
    }

    /// The works that wait or run.
    pub fn works(&self) -> impl Iterator<Item = &Live> {
        self.works.values()
    }

    /// Whether there is a result.
    pub fn has_result(&self, key: &str) -> bool {
        self.results.contains_key(key)
    }

    /// Works that wait, and works that run.
    pub fn counts(&self) -> (usize, usize) {
        let running = self.works.values().filter(|live| live.is_running).count();
        (self.works.len() - running, running)
    }

    /// Bytes of all results.
    pub fn kept_bytes(&self) -> u64 {
        self.results.values().map(|kept| kept.bytes).sum()
    }

    /// Whether a client may have one more job, with this many bytes of models.
    ///
    /// # Errors
    /// Which limit it is at.
    pub fn admit(&self, client: &str, bytes: u64, limits: &Limits) -> Result<(), ApiError> {
        if self.counts().0 >= limits.waiting {
            let most = limits.waiting;
            return Err(ApiError::busy(format!(
                "{most} jobs wait, which is the most (--max-waiting); try later"
            )));
        }
        let mut own = (0, bytes);
        for live in self.works.values() {
            for id in &live.jobs {
                if self.jobs.get(id).is_some_and(|job| job.client == client) {
                    own = (own.0 + 1, own.1 + live.work.model_bytes);
                }
            }
        }
        if own.0 >= limits.jobs_per_client {
            let most = limits.jobs_per_client;
            return Err(ApiError::too_many(format!(
                "you have {most} jobs that wait or run, which is the most (--max-jobs-per-client); try later"
            )));
        }
        if own.1 > limits.bytes_per_client {
            let most = shown(limits.bytes_per_client);
            return Err(ApiError::too_many(format!(
                "the models of your jobs that wait or run would have more than {most} (--max-bytes-per-client); try later"
            )));
        }
        Ok(())
    }

    /// Takes a job.
    ///
    /// # Errors
    /// A limit is reached, or its idempotency key is that of another job.
    pub fn accept(
        &mut self,
        offer: Offer,
        limits: &Limits,
        changes: &mut Changes,
    ) -> Result<Accepted, ApiError> {
        let Offer { id, mut job, mut work } = offer;
        if let Some(name) = &job.idempotency_key
            && let Some(known) = self.named.get(&(job.client.clone(), name.clone()))
        {
            let is_same = self.jobs.get(known).is_some_and(|known| known.fingerprint == job.fingerprint);
            return match is_same {
                true => Ok(Accepted::Repeated(known.clone())),
                false => Err(ApiError::unusable(
                    ErrorKind::Usage,
                    "this Idempotency-Key was given to another job; give each job its own",
                )),
            };
        }
        let key = job.key.clone();
        self.clock += 1;
        job.seq = self.clock;
        let accepted = if let Some(kept) = self.results.get_mut(&key) {
            kept.used = self.clock;
            job.outcome = Some(Outcome::Done);
            job.finished_s = Some(job.created_s);
            Accepted::Known
        } else {
            self.admit(&job.client, work.model_bytes, limits)?;
            match self.works.get_mut(&key) {
                Some(live) => {
                    live.jobs.push(id.clone());
                    let more = work.outputs.iter().filter(|output| !live.work.outputs.contains(output));
                    let more: Vec<_> = more.copied().collect();
                    live.work.outputs.extend(more);
                    changes.work(&key, &live.work);
                    Accepted::Joined
                }
                None => {
                    work.seq = self.clock;
                    changes.work(&key, &work);
                    let live =
                        Live { work, jobs: vec![id.clone()], is_running: false, signs: Arc::default() };
                    self.works.insert(key, live);
                    Accepted::New
                }
            }
        };
        changes.job(&id, &job);
        self.insert(id, job);
        self.forget_oldest(limits.jobs_kept, changes);
        Ok(accepted)
    }

    /// Forgets finished jobs beyond a number.
    fn forget_oldest(&mut self, most: usize, changes: &mut Changes) {
        if self.jobs.len() <= most + self.works.len() {
            return;
        }
        let finished = self.jobs.iter().filter(|(_, job)| job.outcome.is_some());
        let mut finished: Vec<(u64, String)> = finished.map(|(id, job)| (job.seq, id.clone())).collect();
        let spare = finished.len().saturating_sub(most);
        finished.sort_unstable();
        for (_, id) in finished.into_iter().take(spare) {
            self.forget(&id);
            changes.no_job(&id);
        }
    }

    /// Takes back what was accepted, as it could not be written.
    pub fn forget(&mut self, id: &str) {
        let Some(job) = self.jobs.remove(id) else { return };
        if let Some(name) = job.idempotency_key {
            self.named.remove(&(job.client, name));
        }
        if let Some(live) = self.works.get_mut(&job.key) {
            live.jobs.retain(|other| other != id);
        }
    }

    /// The next work: of the client who waits longest for a turn, the one that came first.
    pub fn next(&mut self, changes: &mut Changes) -> Option<Turn> {
        let waiting = self.works.iter().filter(|(_, live)| !live.is_running);
        let turn = |live: &Live| (self.served.get(&live.work.client).copied().unwrap_or(0), live.work.seq);
        let (key, _) = waiting.min_by_key(|(_, live)| turn(live))?;
        let key = key.clone();
        self.clock += 1;
        let live = self.works.get_mut(&key)?;
        live.is_running = true;
        live.work.attempts += 1;
        self.served.insert(live.work.client.clone(), self.clock);
        changes.work(&key, &live.work);
        live.signs.tell();
        Some(Turn { key, work: live.work.clone(), signs: live.signs.clone() })
    }

    /// A work that was begun shall be done after the next start.
    pub fn give_back(&mut self, key: &str, changes: &mut Changes) {
        if let Some(live) = self.works.get_mut(key) {
            live.is_running = false;
            live.work.attempts = live.work.attempts.saturating_sub(1);
            changes.work(key, &live.work);
        }
    }

    /// The run of a work that nobody wanted has ended. Another job may want it by now: then it waits again.
    pub fn end_cancelled(&mut self, key: &str, now_s: u64, changes: &mut Changes) -> Option<Work> {
        let live = self.works.get_mut(key)?;
        if live.jobs.is_empty() {
            return self.finish(key, Outcome::Cancelled, None, now_s, changes);
        }
        live.signs.tell();
        live.signs = Arc::default();
        self.give_back(key, changes);
        None
    }

    /// A work has ended, and with it its jobs. What it was is returned.
    pub fn finish(
        &mut self,
        key: &str,
        outcome: Outcome,
        kept: Option<Kept>,
        now_s: u64,
        changes: &mut Changes,
    ) -> Option<Work> {
        let live = self.works.remove(key)?;
        changes.no_work(key);
        for id in &live.jobs {
            if let Some(job) = self.jobs.get_mut(id) {
                job.outcome = Some(outcome.clone());
                job.finished_s = Some(now_s);
                changes.job(id, job);
            }
        }
        if let Some(mut kept) = kept {
            self.clock += 1;
            kept.used = self.clock;
            changes.result(key, &kept);
            self.results.insert(key.to_owned(), kept);
        }
        live.signs.tell();
        Some(live.work)
    }

    /// Takes results away, the one that was not used for longest first, until the others have room. Their keys are returned.
    pub fn make_room(&mut self, quota_bytes: u64, changes: &mut Changes) -> Vec<String> {
        let mut bytes = self.kept_bytes();
        let mut oldest: Vec<(u64, String)> =
            self.results.iter().map(|(key, kept)| (kept.used, key.clone())).collect();
        oldest.sort_unstable();
        let mut gone = Vec::new();
        for (_, key) in oldest {
            if bytes <= quota_bytes {
                break;
            }
            bytes -= self.results.remove(&key).map_or(0, |kept| kept.bytes);
            changes.no_result(&key);
            gone.push(key);
        }
        gone
    }

    /// The job of a client; those of others are not there.
    pub fn job(&self, id: &str, client: &str) -> Result<&Job, ApiError> {
        let job = self.jobs.get(id).filter(|job| job.client == client);
        job.ok_or_else(|| ApiError::not_found("there is no such job"))
    }

    /// The result of a job, which is used by this.
    ///
    /// # Errors
    /// It is not there yet, there is none, or none any more.
    pub fn result(&mut self, id: &str, client: &str) -> Result<(Job, Kept), ApiError> {
        let job = self.job(id, client)?.clone();
        match &job.outcome {
            None => Err(ApiError::new(
                axum::http::StatusCode::CONFLICT,
                ErrorKind::Usage,
                "this job is not done yet; ask for its state, or follow its events",
            )
            .retry_after(1)),
            Some(Outcome::Failed(problem)) => Err(ApiError::from(problem.clone())),
            Some(Outcome::Cancelled) => Err(ApiError::gone("this job was cancelled: it has no result")),
            Some(Outcome::Done) => {
                self.clock += 1;
                let clock = self.clock;
                let kept = self.results.get_mut(&job.key).ok_or_else(|| {
                    ApiError::gone("this result had to make room for others (--max-disk); send the job again")
                })?;
                kept.used = clock;
                Ok((job, kept.clone()))
            }
        }
    }

    /// A client does not want a job any more; a work that nobody wants is cancelled. True: it ends with this.
    ///
    /// # Errors
    /// There is no such job.
    pub fn cancel(
        &mut self,
        id: &str,
        client: &str,
        now_s: u64,
        changes: &mut Changes,
    ) -> Result<Option<Work>, ApiError> {
        let job = self.job(id, client)?;
        if job.outcome.is_some() {
            return Ok(None);
        }
        let key = job.key.clone();
        if let Some(job) = self.jobs.get_mut(id) {
            job.outcome = Some(Outcome::Cancelled);
            job.finished_s = Some(now_s);
            changes.job(id, job);
        }
        let Some(live) = self.works.get_mut(&key) else { return Ok(None) };
        live.jobs.retain(|other| other != id);
        live.signs.tell();
        if !live.jobs.is_empty() {
            return Ok(None);
        }
        live.signs.cancelled.store(true, Ordering::Relaxed);
        match live.is_running {
            // Its run ends it.
            true => Ok(None),
            false => Ok(self.finish(&key, Outcome::Cancelled, None, now_s, changes)),
        }
    }

    /// Deletes a job, and its result if it is nobody else's. The key of that is returned.
    ///
    /// # Errors
    /// There is no such job.
    pub fn delete(
        &mut self,
        id: &str,
        client: &str,
        changes: &mut Changes,
    ) -> Result<Option<String>, ApiError> {
        let key = self.job(id, client)?.key.clone();
        self.forget(id);
        changes.no_job(id);
        let is_needed = self.jobs.values().any(|job| job.key == key);
        if is_needed || self.results.remove(&key).is_none() {
            return Ok(None);
        }
        changes.no_result(&key);
        Ok(Some(key))
    }

    /// A job as it is told.
    ///
    /// # Errors
    /// There is no such job.
    pub fn view(&self, id: &str, client: &str) -> Result<JobView, ApiError> {
        self.job(id, client).map(|job| self.view_of(id, job))
    }

    fn view_of(&self, id: &str, job: &Job) -> JobView {
        let live = self.works.get(&job.key).filter(|_| job.outcome.is_none());
        let kept = self.results.get(&job.key);
        let (state, error) = match (&job.outcome, live) {
            (Some(Outcome::Done), _) if kept.is_some() => (State::Done, None),
            (Some(Outcome::Done), _) => (State::Expired, None),
            (Some(Outcome::Failed(problem)), _) => (State::Failed, Some(problem.clone())),
            (Some(Outcome::Cancelled), _) => (State::Cancelled, None),
            (None, Some(live)) if live.is_running => (State::Running, None),
            (None, _) => (State::Waiting, None),
        };
        let is_before = |other: &&Live, own: &Live| other.is_running || other.work.seq < own.work.seq;
        JobView {
            id: id.to_owned(),
            state,
            name: self.gcode_name(job, kept),
            key: job.key.clone(),
            created_s: job.created_s,
            finished_s: job.finished_s,
            progress: live.filter(|live| live.is_running).map(|live| live.signs.progress()),
            ahead: live
                .filter(|live| !live.is_running)
                .map(|own| self.works.values().filter(|other| is_before(other, own)).count()),
            gcode_bytes: kept.filter(|_| state == State::Done).map(|kept| kept.gcode_bytes),
            runs: kept.filter(|_| state == State::Done).map(|kept| kept.runs),
            error,
        }
    }

    /// What the G-code of a job is called.
    pub fn gcode_name(&self, job: &Job, kept: Option<&Kept>) -> String {
        kept.and_then(|kept| kept.file_name.clone()).unwrap_or_else(|| job.name.clone())
    }

    /// Jobs of a client, the latest first.
    pub fn list(&self, client: &str, state: Option<State>, most: usize) -> Vec<JobView> {
        let own = self.jobs.iter().filter(|(_, job)| job.client == client);
        let mut own: Vec<(&String, &Job)> = own.collect();
        own.sort_unstable_by_key(|(_, job)| std::cmp::Reverse(job.seq));
        let views = own.into_iter().map(|(id, job)| self.view_of(id, job));
        views.filter(|view| state.is_none_or(|state| view.state == state)).take(most).collect()
    }

    /// Wakes up when a job changes; `None`: it has ended, and does not.
    pub fn watch(&self, id: &str) -> Option<watch::Receiver<()>> {
        let job = self.jobs.get(id).filter(|job| job.outcome.is_none())?;
        self.works.get(&job.key).map(|live| live.signs.watch())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn offer(id: &str, client: &str, key: &str) -> Offer {
        let job = Job {
            seq: 0,
            client: client.into(),
            key: key.into(),
            name: "part.gcode".into(),
            created_s: 1,
            outcome: None,
            finished_s: None,
            idempotency_key: None,
            fingerprint: key.into(),
        };
        let work = Work {
            seq: 0,
            client: client.into(),
            project: "p".into(),
            models: Vec::new(),
            model_bytes: 10,
            outputs: Vec::new(),
            attempts: 0,
        };
        Offer { id: id.into(), job, work }
    }

    fn accept(index: &mut Index, id: &str, client: &str, key: &str) -> Accepted {
        index.accept(offer(id, client, key), &Limits::default(), &mut Changes::default()).unwrap()
    }

    const KEPT: Kept = Kept { file_name: None, binary: false, gcode_bytes: 9, bytes: 10, runs: 1, used: 0 };

    fn state(index: &Index, id: &str, client: &str) -> State {
        index.view(id, client).unwrap().state
    }

    #[test]
    fn jobs_that_are_alike_are_done_once() {
        let (mut index, mut changes) = (Index::default(), Changes::default());
        assert_eq!(accept(&mut index, "1", "ana", "k"), Accepted::New);
        assert_eq!(accept(&mut index, "2", "ben", "k"), Accepted::Joined);
        assert_eq!(index.next(&mut changes).unwrap().key, "k");
        assert!(index.next(&mut changes).is_none());
        index.finish("k", Outcome::Done, Some(KEPT), 2, &mut changes);
        assert_eq!((state(&index, "1", "ana"), state(&index, "2", "ben")), (State::Done, State::Done));
        assert_eq!(accept(&mut index, "3", "ben", "k"), Accepted::Known);
        assert_eq!(state(&index, "3", "ben"), State::Done);
    }

    #[test]
    fn clients_take_turns() {
        let (mut index, mut changes) = (Index::default(), Changes::default());
        for (id, client) in [("1", "ana"), ("2", "ana"), ("3", "ana"), ("4", "ben"), ("5", "cem")] {
            accept(&mut index, id, client, id);
        }
        let turns: Vec<String> =
            std::iter::from_fn(|| index.next(&mut changes)).map(|turn| turn.key).collect();
        assert_eq!(turns, ["1", "4", "5", "2", "3"]);
    }

    #[test]
    fn a_work_is_cancelled_when_nobody_wants_it() {
        let (mut index, mut changes) = (Index::default(), Changes::default());
        accept(&mut index, "1", "ana", "k");
        accept(&mut index, "2", "ben", "k");
        let turn = index.next(&mut changes).unwrap();
        assert!(index.cancel("1", "ben", 2, &mut changes).is_err(), "it is not hers");
        index.cancel("1", "ana", 2, &mut changes).unwrap();
        assert!(!turn.signs.cancelled.load(Ordering::Relaxed));
        index.cancel("2", "ben", 2, &mut changes).unwrap();
        assert!(turn.signs.cancelled.load(Ordering::Relaxed));
        assert_eq!(state(&index, "2", "ben"), State::Cancelled);
    }

    #[test]
    fn limits_are_named() {
        let mut index = Index::default();
        let limits = Limits { waiting: 3, jobs_per_client: 2, bytes_per_client: 15, ..Limits::default() };
        let mut take = |id: &str, client: &str| {
            let taken = index.accept(offer(id, client, id), &limits, &mut Changes::default());
            taken.err().map(|error| error.problem().message.clone()).unwrap_or_default()
        };
        assert_eq!(take("1", "ana"), "");
        assert!(take("2", "ana").contains("--max-bytes-per-client"));
        assert_eq!(take("3", "ben"), "");
        assert_eq!(take("4", "cem"), "");
        assert!(take("5", "dan").contains("--max-waiting"));
        let limits = Limits { jobs_per_client: 1, ..Limits::default() };
        let error = index.accept(offer("6", "ana", "6"), &limits, &mut Changes::default()).unwrap_err();
        assert!(error.problem().message.contains("--max-jobs-per-client"));
    }

    #[test]
    fn what_ran_when_the_server_died_waits_again_but_not_for_ever() {
        let limits = Limits { attempts: 2, ..Limits::default() };
        let (mut index, mut changes) = (Index::default(), Changes::default());
        accept(&mut index, "1", "ana", "k");
        let records = |index: &Index| Records {
            jobs: index.jobs.clone().into_iter().collect(),
            works: index.works.iter().map(|(key, live)| (key.clone(), live.work.clone())).collect(),
            results: index.results.clone().into_iter().collect(),
        };
        index.next(&mut changes);
        let mut index = Index::of(records(&index), &limits, 2, &mut changes);
        assert_eq!(state(&index, "1", "ana"), State::Waiting);
        index.next(&mut changes);
        let index = Index::of(records(&index), &limits, 3, &mut changes);
        assert_eq!(state(&index, "1", "ana"), State::Failed);
    }

    #[test]
    fn the_oldest_results_make_room_and_a_deleted_job_takes_its_own_with_it() {
        let (mut index, mut changes) = (Index::default(), Changes::default());
        for id in ["1", "2", "3"] {
            accept(&mut index, id, "ana", id);
            index.next(&mut changes);
            index.finish(id, Outcome::Done, Some(KEPT), 2, &mut changes);
        }
        index.result("1", "ana").unwrap();
        assert_eq!(index.make_room(20, &mut changes), ["2"], "the first was used since");
        assert_eq!(state(&index, "2", "ana"), State::Expired);
        assert_eq!(index.delete("3", "ana", &mut changes).unwrap().as_deref(), Some("3"));
        assert!(index.view("3", "ana").is_err());
        accept(&mut index, "4", "ben", "1");
        assert_eq!(index.delete("1", "ana", &mut changes).unwrap(), None, "ben has it, too");
    }

    #[test]
    fn a_repeated_request_is_the_same_job() {
        let mut index = Index::default();
        let mut send = |id: &str, key: &str| {
            let mut offer = offer(id, "ana", key);
            offer.job.idempotency_key = Some("mine".into());
            index.accept(offer, &Limits::default(), &mut Changes::default())
        };
        assert_eq!(send("1", "k").unwrap(), Accepted::New);
        assert_eq!(send("2", "k").unwrap(), Accepted::Repeated("1".into()));
        assert!(send("3", "other").is_err());
    }
}
