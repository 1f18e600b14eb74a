//! What people see: messages, results, the progress bar.

use std::fmt::Display;
use std::io::{self, ErrorKind, IsTerminal, Write};
use std::path::Path;
use std::sync::OnceLock;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressState, ProgressStyle};
use serde::Serialize;

use super::exit::{Exit, Failure};
use crate::observer::Observer;

/// One line on standard error for each warning.
pub(super) fn warn<T: Display>(warnings: &[T]) {
    for warning in warnings {
        // If standard error is closed, no message is possible.
        let _ = writeln!(io::stderr(), "warning: {warning}");
    }
}

/// One line on standard error: what is going on.
#[cfg(feature = "send")]
pub(super) fn tell(event: impl Display) {
    let _ = writeln!(io::stderr(), "{event}");
}

/// One line on standard error for each problem.
pub(super) fn fail(failure: &Failure) {
    for message in &failure.messages {
        let _ = writeln!(io::stderr(), "error: {message}");
    }
}

/// The same; with `json` also as a line of JSON on standard output.
pub(super) fn fail_as(failure: &Failure, json: bool) -> Result<(), Failure> {
    fail(failure);
    if json { print_json(&failure.to_json()) } else { Ok(()) }
}

/// Text on standard output. That its reader has seen enough (`| head`) is no failure.
pub(super) fn print(text: &str) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::new(Exit::Output, format!("standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// One line of JSON on standard output.
pub(super) fn print_json(value: &impl Serialize) -> Result<(), Failure> {
    let text = serde_json::to_string(value).map_err(|error| Failure::new(Exit::Output, error))?;
    print(&(text + "\n"))
}

/// Layers done, layers a second, time left.
pub(super) struct Bar(ProgressBar);

impl Bar {
    /// A bar on standard error if it is wanted and that is a terminal.
    pub fn on_terminal(wanted: bool) -> Option<Self> {
        if !wanted || !io::stderr().is_terminal() {
            return None;
        }
        let style = ProgressStyle::with_template("{bar:40} {pos}/{len} layers, {rate} layers/s, {eta} left")
            .unwrap_or_else(|_| ProgressStyle::default_bar())
            .with_key("rate", |state: &ProgressState, out: &mut dyn std::fmt::Write| {
                // Too little room for a number is no reason to fail.
                let _ = write!(out, "{:.0}", state.per_sec());
            });
        Some(Self(ProgressBar::new(0).with_style(style)))
    }

    /// Who moves the bar, where there is one, and has a clock.
    pub fn observer(bar: Option<&Self>) -> Observer<'static> {
        let observer = Observer::none().timed_by(clock);
        let Some(Self(bar)) = bar else { return observer };
        let bar = bar.clone();
        observer.on_progress(move |done, of| {
            bar.set_length(of as u64);
            bar.set_position(done as u64);
        })
    }

    /// Takes the bar off the terminal.
    pub fn remove(self) {
        self.0.finish_and_clear();
    }
}

/// Time since the first call.
fn clock() -> Duration {
    static BEGUN: OnceLock<Instant> = OnceLock::new();
    BEGUN.get_or_init(Instant::now).elapsed()
}

/// The date that `SOURCE_DATE_EPOCH` gives, seconds since 1970 (<https://reproducible-builds.org/specs/source-date-epoch/>).
pub(super) fn source_date() -> Option<u64> {
    std::env::var("SOURCE_DATE_EPOCH").ok()?.parse().ok()
}

/// The name of a file, without its folder.
pub(super) fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}
