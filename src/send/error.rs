//! What can go wrong on the way to a print, said so that it can be mended.

use std::fmt;

/// What was being done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Reading what the user says about the host.
    Configure,
    /// Asking who it is.
    Ask,
    /// Asking for its state.
    State,
    /// Looking for a file of this name, and for space.
    Look,
    /// Comparing the file with the printer.
    Examine,
    /// Sending the file.
    Upload,
    /// Comparing what is stored with what was sent.
    Verify,
    /// Starting the print.
    Start,
    /// Following the print.
    Follow,
}

impl Step {
    /// In words, after the host's name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Configure => "configuration",
            Self::Ask => "asking who it is",
            Self::State => "asking for its state",
            Self::Look => "looking for the file",
            Self::Examine => "comparing the file with the printer",
            Self::Upload => "upload",
            Self::Verify => "comparing what was stored",
            Self::Start => "start",
            Self::Follow => "following the print",
        }
    }
}

/// Why it failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// What the user says about the host makes no sense.
    Settings,
    /// The local file cannot be read, or changes while it is sent.
    File,
    /// The file is not for this printer.
    Mismatch,
    /// No route, no name, no answer, or a connection that breaks.
    Unreachable,
    /// Its certificate is not trusted, or the connection cannot be encrypted.
    Certificate,
    /// It sends us elsewhere.
    Redirected,
    /// The key is wrong, missing or does not suffice.
    Key,
    /// A file of this name exists.
    Exists,
    /// It has too little space.
    Space,
    /// It prints, is paused, has an error, or is not connected to its printer.
    NotReady,
    /// It answers that it failed, or in a way that its interface does not have.
    Answer,
    /// What it stored is not what was sent.
    Damaged,
    /// Whether it did what was asked cannot be found out.
    Unclear,
    /// The print was cancelled or failed.
    Ended,
}

/// A failure: which host, which step, what it answered, and what to do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SendError {
    /// The host's name.
    pub host: String,
    /// What was being done.
    pub step: Step,
    /// Why it failed.
    pub cause: Cause,
    /// What happened, or what the host answered.
    pub message: String,
    /// What to do about it.
    pub advice: String,
    /// Whether the same may succeed a little later.
    pub(super) is_transient: bool,
    /// Whether the request was never sent.
    pub(super) is_unsent: bool,
}

impl SendError {
    pub(super) fn new(
        host: &str,
        step: Step,
        cause: Cause,
        message: impl Into<String>,
        advice: impl Into<String>,
    ) -> Self {
        Self {
            host: host.to_owned(),
            step,
            cause,
            message: message.into(),
            advice: advice.into(),
            is_transient: false,
            is_unsent: false,
        }
    }

    pub(super) fn transient(self) -> Self {
        Self { is_transient: true, ..self }
    }
}

impl fmt::Display for SendError {
    /// `host, step: message; advice`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, {}: {}", self.host, self.step.name(), self.message)?;
        if self.advice.is_empty() { Ok(()) } else { write!(f, "; {}", self.advice) }
    }
}

impl std::error::Error for SendError {}
