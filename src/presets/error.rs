//! What is wrong with presets, or with the choice of them.

use std::fmt;

use super::config::Place;

/// What is wrong, and where.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub struct PresetError {
    /// Where it was written; `None`: it is about a choice, or about what is not there.
    pub place: Option<Place>,
    /// What is wrong, and what would be right.
    pub message: String,
}

impl PresetError {
    /// Something wrong in a file.
    pub fn at(place: Place, message: impl Into<String>) -> Self {
        Self { place: Some(place), message: message.into() }
    }

    /// Something wrong that stands nowhere.
    pub fn of(message: impl Into<String>) -> Self {
        Self { place: None, message: message.into() }
    }
}

impl fmt::Display for PresetError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.place {
            Some(place) => write!(f, "{place}: {}", self.message),
            None => f.write_str(&self.message),
        }
    }
}
