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
    /// The time that was allowed is over.
    TimedOut = 8,
    /// The memory that was allowed does not suffice.
    Memory = 9,
    /// A print host cannot be reached, is not trusted, or answers that it failed.
    Host = 10,
    /// A print host refuses: the key, the name, the space, or the state of its printer.
    Refused = 11,
    /// The print that was waited for was cancelled or failed.
    PrintFailed = 12,
    /// Ended by a signal.
    Interrupted = 130,
}

impl Exit {
    /// In a word, for programs.
    fn kind(self) -> &'static str {
        match self {
            Self::Done => "done",
            Self::Usage => "usage",
            Self::Input => "input",
            Self::Settings => "settings",
            Self::DoesNotFit => "does_not_fit",
            Self::Output => "output",
            Self::Check => "check",
            Self::TimedOut => "timeout",
            Self::Memory => "memory",
            Self::Host => "host",
            Self::Refused => "refused",
            Self::PrintFailed => "print_failed",
            Self::Interrupted => "interrupted",
        }
    }
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
    /// The object, the file and the setting that are at fault, where it is one.
    pub object: Option<String>,
    pub file: Option<String>,
    pub key: Option<String>,
}

impl Failure {
    pub fn new(exit: Exit, message: impl ToString) -> Self {
        Self::of(exit, vec![message.to_string()])
    }

    fn of(exit: Exit, messages: Vec<String>) -> Self {
        Self { exit, messages, object: None, file: None, key: None }
    }

    /// For programs.
    pub fn to_json(&self) -> serde_json::Value {
        serde_json::json!({ "error": {
            "kind": self.exit.kind(),
            "exit": self.exit as u8,
            "message": self.messages.join("\n"),
            "object": self.object,
            "file": self.file,
            "key": self.key,
        }})
    }
}

/// That the arguments make no sense.
pub(super) fn usage(message: impl ToString) -> Failure {
    Failure::new(Exit::Usage, message)
}

impl From<ProfileError> for Failure {
    fn from(error: ProfileError) -> Self {
        let key = error.problems.iter().find_map(|problem| Some(problem.setting.clone()?.0));
        let messages = error.problems.iter().map(ToString::to_string).collect();
        Self { key, ..Self::of(Exit::Settings, messages) }
    }
}

impl From<OutputError> for Failure {
    fn from(error: OutputError) -> Self {
        // Whoever closed the pipe knows; that not everything was written still shows in the exit code.
        let messages = if error.is_broken_pipe() { Vec::new() } else { vec![error.to_string()] };
        Self::of(Exit::Output, messages)
    }
}

#[cfg(feature = "send")]
impl From<crate::send::SendError> for Failure {
    fn from(error: crate::send::SendError) -> Self {
        use crate::send::Cause;
        let exit = match error.cause {
            Cause::Settings => Exit::Settings,
            Cause::File => Exit::Input,
            Cause::Mismatch => Exit::Check,
            Cause::Unreachable
            | Cause::Certificate
            | Cause::Redirected
            | Cause::Answer
            | Cause::Damaged
            | Cause::Unclear => Exit::Host,
            Cause::Key | Cause::Exists | Cause::Space | Cause::NotReady => Exit::Refused,
            Cause::Ended => Exit::PrintFailed,
        };
        Self::new(exit, error)
    }
}

#[cfg(feature = "send")]
impl From<crate::send::HostsError> for Failure {
    fn from(error: crate::send::HostsError) -> Self {
        Self::new(Exit::Settings, error)
    }
}

impl From<JobError> for Failure {
    fn from(error: JobError) -> Self {
        let (object, file) = (error.object().map(str::to_owned), error.file());
        let failure = match error {
            JobError::Mesh(error) => Self::new(Exit::Input, error),
            JobError::Input(error) => Self::new(Exit::Input, error),
            JobError::Settings(error) => error.into(),
            JobError::Script { .. } => Self::new(Exit::Settings, error),
            JobError::DoesNotFit(error) => Self::new(Exit::DoesNotFit, error),
            JobError::Output(error) => error.into(),
            JobError::Check(error) => Self::new(Exit::Check, error),
            JobError::Cancelled => Self::new(Exit::Interrupted, "interrupted"),
        };
        Self { object, file, ..failure }
    }
}
