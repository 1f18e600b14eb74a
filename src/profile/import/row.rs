//! A row of the table, and what comes of it.

use toml::Value;

use crate::presets::Config;

/// What came of one row of the table.
pub(super) enum Outcome {
    /// The value of our key.
    Value(Value),
    /// The same, but it does not mean quite the same, for this reason.
    Near(Value, String),
    /// There is nothing like it here.
    Left(String),
    /// It says what is so anyway.
    Idle,
}

/// How a value becomes ours.
#[derive(Clone, Copy)]
pub(super) enum How {
    /// As it is, of the first extruder; the first of their keys that is set.
    Same,
    /// The same, of a single nozzle to which several filaments are fed.
    OfNozzle,
    /// By a rule of its own.
    With(fn(&Config) -> Outcome),
}

/// One setting of ours.
pub(super) struct Row {
    /// Our key.
    pub ours: &'static str,
    /// Their keys that say something of it; it is looked at as soon as one of them is set.
    pub theirs: &'static [&'static str],
    pub how: How,
    /// The rule in words; empty: as it is.
    pub rule: &'static str,
}
