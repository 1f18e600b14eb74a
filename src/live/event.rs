//! What subscribers are told.

use std::sync::Arc;

use serde::Serialize;

use super::placed::Placed;
use super::resolved::Resolved;
use crate::job::JobError;
use crate::report::Summary;

/// Something that became known of a revision. Each serializes as the body of an event.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
pub enum Event {
    /// The settings in force, or why there are none.
    Resolved(Box<Resolved>),
    /// Where everything stands, and what does not fit.
    Placed(Box<Placed>),
    /// How far the slicing is.
    Progress(Progress),
    /// All walls are planned, and can be looked at.
    Walls(Walls),
    /// The print is complete.
    Done(Box<Done>),
    /// There will be no print.
    Failed(Box<Failed>),
}

impl Event {
    /// The name of its kind.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Resolved(_) => "resolved",
            Self::Placed(_) => "placed",
            Self::Progress(_) => "progress",
            Self::Walls(_) => "walls",
            Self::Done(_) => "done",
            Self::Failed(_) => "failed",
        }
    }

    /// The revision that it is about.
    pub fn revision(&self) -> u64 {
        match self {
            Self::Resolved(event) => event.revision,
            Self::Placed(event) => event.revision,
            Self::Progress(event) => event.revision,
            Self::Walls(event) => event.revision,
            Self::Done(event) => event.revision,
            Self::Failed(event) => event.revision,
        }
    }

    /// Whether nothing more follows of its revision.
    pub fn is_last(&self) -> bool {
        match self {
            Self::Resolved(resolved) => !resolved.problems.is_empty(),
            Self::Done(_) | Self::Failed(_) => true,
            _ => false,
        }
    }
}

/// How far a slicing is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Progress {
    /// The revision.
    pub revision: u64,
    /// `sections`, `paths` or `order`.
    pub stage: &'static str,
    /// Layers that are through this stage.
    pub done: usize,
    /// All layers; 0 while that is not known.
    pub of: usize,
}

/// The walls of all layers are planned.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Walls {
    /// The revision.
    pub revision: u64,
    /// How many layers there are.
    pub layers: usize,
    /// The walls, packed; see [`preview`](crate::view::preview).
    #[serde(skip)]
    pub packed: Arc<[u8]>,
}

/// A print is complete.
#[derive(Clone, Debug, Serialize)]
pub struct Done {
    /// The revision.
    pub revision: u64,
    /// What the file should be called.
    pub name: String,
    /// Size of the G-code.
    pub bytes: usize,
    /// Under this key the result may be kept; see [`Job::key`](crate::job::Job::key).
    pub key: String,
    /// The command that gives the same bytes; `None`: one must save the project and slice that.
    pub command: Option<String>,
    /// Whether the command is for a saved project.
    pub project_needed: bool,
    /// What the slicing came to, without the layers.
    pub summary: Summary,
    /// Of the print that was complete before.
    pub before: Option<Before>,
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// Figures of an earlier print, to be compared with.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[allow(missing_docs)]
pub struct Before {
    pub time_s: f64,
    pub filament_g: f64,
    pub cost: f64,
    pub travel_mm: f64,
}

impl Before {
    pub(super) fn of(summary: &Summary) -> Self {
        Self {
            time_s: summary.total.total_s,
            filament_g: summary.filament_g,
            cost: summary.filament_cost,
            travel_mm: summary.total.travel_mm,
        }
    }
}

/// There will be no print.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Failed {
    /// The revision.
    pub revision: u64,
    /// Why not.
    pub error: Fault,
}

/// Why there is no print.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Fault {
    /// What kind of mistake it is.
    pub kind: FaultKind,
    /// What is wrong and how to mend it.
    pub message: String,
    /// The object that it is about.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub object: Option<String>,
    /// The setting that it is about.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub key: Option<String>,
}

/// Kind of a mistake.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FaultKind {
    /// A model cannot be read, or there is nothing to print.
    Input,
    /// A setting or a script.
    Settings,
    /// The models do not fit the printer.
    DoesNotFit,
    /// A check of the result failed, or something would begin in mid-air.
    Check,
    /// A mistake of this program.
    Internal,
}

impl Failed {
    pub(super) fn of(revision: u64, error: &JobError) -> Self {
        let kind = match error {
            JobError::Mesh(_) | JobError::Input(_) => FaultKind::Input,
            JobError::Settings(_) | JobError::Script { .. } => FaultKind::Settings,
            JobError::DoesNotFit(_) => FaultKind::DoesNotFit,
            JobError::Check(_) => FaultKind::Check,
            JobError::Output(_) | JobError::Cancelled => FaultKind::Internal,
        };
        let (object, key) = (error.object().map(str::to_owned), error.key().map(str::to_owned));
        Self { revision, error: Fault { kind, message: error.to_string(), object, key } }
    }

    pub(super) fn internal(revision: u64) -> Self {
        let message = "a mistake of this program; the session goes on: change something, or slice it on the \
                       command line and report what that says";
        let error = Fault { kind: FaultKind::Internal, message: message.to_owned(), object: None, key: None };
        Self { revision, error }
    }
}
