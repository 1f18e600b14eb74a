//! What goes wrong with input.

use std::io;

use crate::job::JobError;
use crate::source::Source;

/// Input that cannot be read.
pub(super) fn input_error(source: &Source, error: &io::Error) -> JobError {
    JobError::Input(format!("{source}: {error}"))
}
