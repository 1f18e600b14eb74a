//! What is wrong with a profile: every problem at once, one line each.

use std::fmt;

use crate::presets::Place;

/// Where a setting was written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Origin {
    /// An embedded profile, by name.
    Embedded(String),
    /// A profile file, by path.
    File(String),
    /// A line of another slicer's configuration or preset.
    Line(Place),
    /// A value that another slicer's scripts may name.
    Variables,
    /// A project's own profile or settings.
    Project,
    /// A command-line option, such as `--set` or `--order`.
    Option(&'static str),
}

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Embedded(name) => write!(f, "profile {name}"),
            Self::File(path) => f.write_str(path),
            Self::Line(place) => place.fmt(f),
            Self::Variables => f.write_str("the configuration, for its scripts"),
            Self::Project => f.write_str("the project"),
            Self::Option(option) => f.write_str(option),
        }
    }
}

/// One thing that is wrong, or (as a warning) unwise.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    /// Where it was written.
    pub origin: Origin,
    /// The dotted key, with its value as written; `None`: the whole source is meant.
    pub setting: Option<(String, String)>,
    /// The problem and its remedy.
    pub message: String,
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.setting {
            Some((key, value)) => write!(f, "{}: {key} = {value}: {}", self.origin, self.message),
            None => write!(f, "{}: {}", self.origin, self.message),
        }
    }
}

/// Every problem found; at least one. One line each when displayed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub struct ProfileError {
    /// In the order in which the sources were read.
    pub problems: Vec<Problem>,
}

impl fmt::Display for ProfileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, problem) in self.problems.iter().enumerate() {
            if index > 0 {
                f.write_str("\n")?;
            }
            problem.fmt(f)?;
        }
        Ok(())
    }
}
