//! What was repaired of the models.

use std::fmt;

use serde::Serialize;

use crate::mesh::{MeshReport, Repair};

/// One kind of repair of one model. `Display` gives a line in words.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Repaired {
    /// The object.
    pub model: String,
    /// What was done, and how often.
    #[serde(flatten)]
    pub repair: Repair,
}

impl Repaired {
    /// All repairs of a model.
    pub fn of(model: &str, report: &MeshReport) -> Vec<Self> {
        let repairs = report.repairs().into_iter();
        repairs.map(|repair| Self { model: model.to_owned(), repair }).collect()
    }
}

impl fmt::Display for Repaired {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.model, self.repair)
    }
}
