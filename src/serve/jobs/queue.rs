//! The threads that do the work, one job after the other, each with threads of its own to slice with.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Instant;

use rayon::ThreadPool;

use super::hub::Jobs;
use super::index::Turn;
use super::record::{Kept, Outcome};
use super::run::{Ended, run};
use crate::serve::error::{ErrorKind, Problem};
use crate::serve::limits::shown;
use crate::serve::metrics::OutcomeLabels;
use crate::serve::shared::pool;
use crate::serve::tokens::now_s;

/// The threads that do the work.
#[derive(Debug)]
pub struct Runners {
    jobs: Arc<Jobs>,
    threads: Vec<JoinHandle<()>>,
}

impl Runners {
    /// Starts as many as jobs are sliced at once, each with this many threads; 0: as many as the machine has cores.
    ///
    /// # Errors
    /// The system has no more threads.
    pub fn start(jobs: &Arc<Jobs>, at_once: usize, threads: usize) -> std::io::Result<Self> {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let at_once = if at_once == 0 { cores.div_ceil(2) } else { at_once };
        let runner = |index: usize| {
            let (jobs, pool) = (jobs.clone(), pool(threads, "slice")?);
            let work = move || {
                while let Some(turn) = jobs.next() {
                    take(&jobs, &turn, &pool);
                }
            };
            std::thread::Builder::new().name(format!("jobs-{index}")).spawn(work)
        };
        let threads = (0..at_once).map(runner).collect::<Result<_, _>>()?;
        Ok(Self { jobs: jobs.clone(), threads })
    }

    /// Ends them: what runs is begun again after the next start.
    pub fn stop(self) {
        self.jobs.stop();
        for thread in self.threads {
            // Its panics were caught.
            let _ = thread.join();
        }
    }
}

/// Does a work, and writes down what became of it.
fn take(jobs: &Jobs, turn: &Turn, pool: &ThreadPool) {
    let begun = Instant::now();
    jobs.shared.metrics.begun.inc();
    let ended = catch_unwind(AssertUnwindSafe(|| pool.install(|| run(jobs, turn))));
    let ended = ended.unwrap_or_else(|what| Ended::Failed(mistake(&*what)));
    jobs.shared.metrics.run_seconds.observe(begun.elapsed().as_secs_f64());
    let quota = jobs.shared.limits.quota_bytes;
    let ended = match ended {
        Ended::Done(kept) if kept.bytes > quota => {
            let (bytes, most) = (kept.bytes >> 20, shown(quota));
            let message =
                format!("the result has {bytes} MiB; this server keeps at most {most} (--max-disk)");
            Ended::Failed(Problem { kind: ErrorKind::Limit, message, object: None, key: None })
        }
        ended => ended,
    };
    let is_kept = matches!(ended, Ended::Done(_));
    let outcome = match ended {
        Ended::Done(kept) => ("done", Some((Outcome::Done, Some(kept)))),
        Ended::Failed(problem) => ("failed", Some((Outcome::Failed(problem), None))),
        Ended::Stopped => ("cancelled", None),
    };
    if !is_kept {
        jobs.files.remove_result(&turn.key);
    }
    jobs.shared.metrics.ended.get_or_create(&OutcomeLabels { outcome: outcome.0 }).inc();
    end(jobs, turn, outcome.1);
}

/// Writes down how a work ended. What cannot be written is done again after the next start.
fn end(jobs: &Jobs, turn: &Turn, outcome: Option<(Outcome, Option<Kept>)>) {
    let quota = jobs.shared.limits.quota_bytes;
    let (mut over, mut gone) = (None, Vec::new());
    // Without this the jobs would wait for ever, and with it they are only done once more: the result of a failure is unused.
    let _ = jobs.change(|index, changes| {
        match outcome {
            Some((outcome, kept)) => {
                over = index.finish(&turn.key, outcome, kept, now_s(), changes);
                gone = index.make_room(quota, changes);
            }
            None if jobs.is_stopping() => index.give_back(&turn.key, changes),
            None => over = index.end_cancelled(&turn.key, now_s(), changes),
        }
        Ok(())
    });
    gone.iter().for_each(|key| jobs.files.remove_result(key));
    if let Some(work) = over {
        jobs.release(&work);
    }
}

/// What a panic says.
fn mistake(what: &(dyn Any + Send)) -> Problem {
    let said = what.downcast_ref::<String>().map(String::as_str);
    let said = said.or_else(|| what.downcast_ref::<&str>().copied()).unwrap_or("unknown");
    let message = format!("a mistake of this program: {said}");
    Problem { kind: ErrorKind::Internal, message, object: None, key: None }
}
