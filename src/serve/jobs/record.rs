//! What is known of jobs, as it is stored and as it is told.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::serve::error::Problem;

/// A job, from when it was accepted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Job {
    /// Position in the order in which jobs came.
    pub seq: u64,
    /// Whose it is.
    pub client: String,
    /// Key of its result.
    pub key: String,
    /// What its G-code is called, unless the settings choose a name.
    pub name: String,
    /// When it came, seconds since 1970.
    pub created_s: u64,
    /// How it ended; `None`: it waits or runs.
    pub outcome: Option<Outcome>,
    /// When it ended, seconds since 1970.
    pub finished_s: Option<u64>,
    /// The key that the client gave to it.
    pub idempotency_key: Option<String>,
    /// Hash of the request, by which a repeated one is known.
    pub fingerprint: String,
}

/// How a job ended.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// Its result was made.
    Done,
    /// There is no result.
    Failed(Problem),
    /// Its client did not want it any more.
    Cancelled,
}

/// A result that is to be made, for one job or several that are alike.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Work {
    /// Position in the order in which they came.
    pub seq: u64,
    /// Whose job came first.
    pub client: String,
    /// Hash of the file with the project.
    pub project: String,
    /// Names and hashes of the models.
    pub models: Vec<ModelRef>,
    /// Bytes of the models.
    pub model_bytes: u64,
    /// What is made beside G-code and summary.
    pub outputs: Vec<Output>,
    /// Runs that began and were not given back.
    pub attempts: u32,
}

/// A model of a work.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ModelRef {
    /// As the client calls it, without folders.
    pub name: String,
    /// SHA-256 of its contents, hexadecimal.
    pub hash: String,
    /// Bytes.
    pub bytes: u64,
}

/// A result that is there.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Kept {
    /// What the settings call the G-code, if they do.
    pub file_name: Option<String>,
    /// Whether the G-code is binary.
    pub binary: bool,
    /// Bytes of the G-code.
    pub gcode_bytes: u64,
    /// Bytes of all files.
    pub bytes: u64,
    /// Runs that it took: more than one where the server died meanwhile.
    pub runs: u32,
    /// When it was made or last used, in the order of such moments.
    pub used: u64,
}

/// What can be made of a job beside G-code and summary.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Output {
    /// The G-code; it is always made.
    Gcode,
    /// The summary; it is always made.
    Summary,
    /// A picture of the whole print.
    Thumbnail,
    /// A page that shows the print.
    Preview,
    /// A picture of each layer.
    Layers,
}

/// What a job is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum State {
    /// It waits for its turn.
    Waiting,
    /// It is sliced.
    Running,
    /// Its result is there.
    Done,
    /// There is no result; `error` says why.
    Failed,
    /// Its client did not want it any more.
    Cancelled,
    /// Its result was there, and had to make room for others.
    Expired,
}

/// Layers that are done, of all.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct Progress {
    /// Layers that are done.
    pub done: usize,
    /// All layers; 0: not known yet.
    pub of: usize,
}

/// A job as it is told.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct JobView {
    /// By which it is asked for.
    pub id: String,
    /// What it is doing.
    pub state: State,
    /// What its G-code is called.
    pub name: String,
    /// SHA-256 of models, settings and version: jobs of one key have one result.
    pub key: String,
    /// When it came, seconds since 1970.
    pub created_s: u64,
    /// When it ended, seconds since 1970.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub finished_s: Option<u64>,
    /// How far it is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub progress: Option<Progress>,
    /// Jobs that come before it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ahead: Option<usize>,
    /// Bytes of the G-code.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gcode_bytes: Option<u64>,
    /// Runs that the result took: more than one where the server died meanwhile.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub runs: Option<u32>,
    /// Why it failed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<Problem>,
}
