//! What is in a model: the answer of `pathwright info`.

use std::fmt;

use serde::Serialize;

/// Facts of one model, and whether it fits the printer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ModelInfo {
    /// As named on the command line.
    pub file: String,
    /// The mesh's facts and repairs as JSON.
    pub mesh: serde_json::Value,
    /// The same as text, one fact per line.
    #[serde(skip)]
    pub text: String,
    /// Objects that it puts on the plate.
    pub objects: usize,
    /// Of these, sets that interlock and are moved together only.
    pub bodies: usize,
    /// Whether it fits the bed.
    pub fits: bool,
    /// What to do if it does not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub advice: Option<String>,
}

impl fmt::Display for ModelInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.file)?;
        for line in self.text.lines() {
            writeln!(f, "  {line}")?;
        }
        match (&self.advice, self.fits) {
            (Some(advice), _) => writeln!(f, "  fits        no: {advice}"),
            (None, fits) => writeln!(f, "  fits        {}", if fits { "yes" } else { "no" }),
        }
    }
}
