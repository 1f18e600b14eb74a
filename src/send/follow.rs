//! A print, followed to its end.

use std::time::Duration;

use super::error::{Cause, SendError, Step};
use super::host::{Activity, Ended, HostState, PrintHost};

/// How often a host is asked.
const ASKED: Duration = Duration::from_secs(1);
/// So many answers in a row make sure of an end: some hosts are ready for a moment between two states.
const SURE: u32 = 2;

/// How a print that was followed ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// To its end.
    Done,
    /// The one who follows has seen enough; the print goes on.
    Left,
}

/// Follows a print until it ends, or until `told`, which is told of every state, returns false.
///
/// # Errors
/// It was cancelled or failed, something else is printed instead, or the host does not answer any more.
pub fn follow(
    host: &dyn PrintHost,
    name: &str,
    told: &mut dyn FnMut(&HostState) -> bool,
) -> Result<Outcome, SendError> {
    let fail = |message: String, advice: &str| {
        SendError::new(host.name(), Step::Follow, Cause::Ended, message, advice)
    };
    let mut sure = 0;
    loop {
        let state = host.state().map_err(|error| {
            let advice = format!("{name} may go on printing: look at the printer; {}", error.advice);
            SendError { step: Step::Follow, advice, ..error }
        })?;
        if !told(&state) {
            return Ok(Outcome::Left);
        }
        let other = state.printing.file.as_deref().filter(|file| *file != name);
        if let (Activity::Printing | Activity::Paused, Some(other)) = (state.activity, other) {
            return Err(fail(format!("it prints {other} instead of {name}"), "look at the printer"));
        }
        // What a printer does after the end of a print is no part of it.
        let is_over = state.ended.is_some() || state.activity == Activity::Ready;
        sure = if is_over { sure + 1 } else { 0 };
        if sure >= SURE {
            return match state.ended {
                // One that does not tell prints no longer.
                Some(Ended::Done) | None => Ok(Outcome::Done),
                Some(Ended::Cancelled) => Err(fail(format!("{name} was cancelled"), "")),
                Some(Ended::Failed) => {
                    Err(fail(format!("{name} failed: {}", state.message), "look at the printer"))
                }
            };
        }
        (host.patience().pause)(ASKED);
    }
}
