//! Exit codes, and the errors that lead to them.

use std::process::ExitCode;

use crate::job::JobError;
use crate::output::OutputError;
use crate::profile::ProfileError;

/// How a run ended. The numbers are documented and do not change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// Everything was done.
    Done = 0,
    /// The arguments make no sense.
    Usage = 2,
    /// A file is unreadable, invalid or too large, or there is nothing to print.
    Input = 3,
    /// Settings are wrong, or a script.
    Settings = 4,
    /// The models do not fit the printer, or cannot be printed one after the other.
    DoesNotFit = 5,
    /// The output cannot be written.
    Output = 6,
    /// A check failed: of the result, of the file to be checked, or something begins in mid-air.
    Check = 7,
    /// Ended by a signal.
    Interrupted = 130,
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        ExitCode::from(exit as u8)
    }
}

/// What went wrong: one message for each problem, and the exit code.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Failure {
    pub exit: Exit,
    pub messages: Vec<String>,
}

impl Failure {
    pub fn new(exit: Exit, message: impl ToString) -> Self {
        Self { exit, messages: vec![message.to_string()] }
    }
}

impl From<ProfileError> for Failure {
    fn from(error: ProfileError) -> Self {
        Self { exit: Exit::Settings, messages: error.problems.iter().map(ToString::to_string).collect() }
    }
}

impl From<OutputError> for Failure {
    fn from(error: OutputError) -> Self {
        // Whoever closed the pipe knows; that not everything was written still shows in the exit code.
        let messages = if error.is_broken_pipe() { Vec::new() } else { vec![error.to_string()] };
        Self { exit: Exit::Output, messages }
    }
}

impl From<JobError> for Failure {
    fn from(error: JobError) -> Self {
        match error {
            JobError::Mesh(error) => Self::new(Exit::Input, error),
            JobError::Input(error) => Self::new(Exit::Input, error),
            JobError::Settings(error) => error.into(),
            JobError::Script { .. } => Self::new(Exit::Settings, error),
            JobError::DoesNotFit(error) => Self::new(Exit::DoesNotFit, error),
            JobError::Output(error) => error.into(),
            JobError::Check(error) => Self::new(Exit::Check, error),
            JobError::Cancelled => Self::new(Exit::Interrupted, "interrupted"),
        }
    }
}
