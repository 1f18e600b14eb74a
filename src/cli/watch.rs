//! What a run may take: time and memory.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use super::args::LimitArgs;
use super::console;
use super::exit::{Exit, Failure};
use crate::limits;
use crate::observer::Observer;
use crate::output;
use crate::system::memory;

/// How often time and memory are looked at.
const EVERY: Duration = Duration::from_millis(10);
/// How long a run may take to end by itself before the process is ended.
const GRACE: Duration = Duration::from_secs(2);

/// Ends a run that takes more than it may: by its observer, and if that does not help soon, with the process. Incomplete output
/// is removed in either case.
pub(super) struct Watch {
    state: Arc<State>,
    timeout: Option<Duration>,
    most_bytes: Option<u64>,
}

#[derive(Default)]
struct State {
    /// Exit code of what was exceeded; 0: nothing.
    exceeded: AtomicU8,
    /// Nobody is to be ended any more.
    is_over: AtomicBool,
}

impl Watch {
    /// Begins to watch, if there is anything to. `json`: how a failure is reported.
    ///
    /// # Errors
    /// The system does not tell how much memory is used.
    pub fn start(args: &LimitArgs, json: bool) -> Result<Self, Failure> {
        let watch = Self { state: Arc::default(), timeout: args.timeout, most_bytes: args.max_memory };
        if let Some(most_bytes) = args.max_memory {
            if memory::used_bytes().is_none() {
                let message = "--max-memory: this system does not tell how much memory is used";
                return Err(Failure::new(Exit::Usage, message));
            }
            memory::allow(most_bytes);
        }
        if args.timeout.is_some() || args.max_memory.is_some() {
            let (state, timeout, most_bytes) = (watch.state.clone(), args.timeout, args.max_memory);
            thread::spawn(move || look(&state, timeout, most_bytes, json));
        }
        Ok(watch)
    }

    /// The same observer, which cancels also what takes too much.
    pub fn over(&self, observer: Observer<'static>) -> Observer<'static> {
        let state = self.state.clone();
        observer.cancelled_when(move || state.exceeded.load(Ordering::Relaxed) != 0)
    }

    /// A failure by its cause, if that is that too much was taken.
    pub fn explained(&self, failure: Failure) -> Failure {
        let refused = || failure.messages.iter().any(|message| message.contains(limits::MEMORY_NEEDED));
        match self.state.exceeded.load(Ordering::Relaxed) {
            code if code == Exit::TimedOut as u8 => {
                Failure { ..exceeded(Exit::TimedOut, self.timeout, None) }
            }
            code if code == Exit::Memory as u8 => exceeded(Exit::Memory, None, self.most_bytes),
            _ if self.most_bytes.is_some() && refused() => Failure { exit: Exit::Memory, ..failure },
            _ => failure,
        }
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        self.state.is_over.store(true, Ordering::Relaxed);
    }
}

fn look(state: &State, timeout: Option<Duration>, most_bytes: Option<u64>, json: bool) {
    let begun = Instant::now();
    let mut since: Option<(Instant, Exit)> = None;
    while !state.is_over.load(Ordering::Relaxed) {
        let used = most_bytes.and_then(|most| Some((memory::used_bytes()?, most)));
        let late = timeout.is_some_and(|timeout| begun.elapsed() > timeout);
        let exit = match used {
            Some((used, most)) if used > most => Some(Exit::Memory),
            _ => late.then_some(Exit::TimedOut),
        };
        if let (Some(exit), None) = (exit, since) {
            state.exceeded.store(exit as u8, Ordering::Relaxed);
            since = Some((Instant::now(), exit));
        }
        // A tenth more is too much to wait any longer.
        let far = used.is_some_and(|(used, most)| used > most.saturating_add(most / 10));
        if let Some((since, exit)) = since.filter(|(since, _)| far || since.elapsed() > GRACE) {
            let _ = since;
            let failure = exceeded(exit, timeout, most_bytes);
            console::fail(&failure);
            if json {
                // The process ends in any case.
                let _ = console::print_json(&failure.to_json());
            }
            output::abandon_and_exit(exit as i32);
        }
        thread::sleep(EVERY);
    }
}

fn exceeded(exit: Exit, timeout: Option<Duration>, most_bytes: Option<u64>) -> Failure {
    let message = match exit {
        Exit::Memory => format!(
            "more than {} MB of memory are needed, which --max-memory does not allow; nothing was written",
            most_bytes.unwrap_or(0) >> 20
        ),
        _ => format!(
            "not done after {} seconds, which --timeout allows; nothing was written",
            timeout.unwrap_or_default().as_secs_f64()
        ),
    };
    Failure::new(exit, message)
}
