//! What every print host can do, whatever its interface.

use serde::Serialize;

use super::error::SendError;
use super::patience::Patience;
use super::payload::Payload;

/// What a host says it is.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct About {
    /// Name and version of its software.
    pub software: String,
    /// The printer's name or model.
    pub printer: Option<String>,
    /// Diameters of its nozzles, mm.
    pub nozzles_mm: Vec<f64>,
    /// Where its nozzle may go.
    pub volume: Option<Volume>,
}

/// Where a nozzle may go, mm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Volume {
    /// Least X, Y and Z.
    pub low: [f64; 3],
    /// Greatest X, Y and Z.
    pub high: [f64; 3],
    /// Whether the bed is a disc.
    pub is_round: bool,
}

/// What a printer does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Activity {
    /// Nothing: it takes a print.
    Ready,
    /// A print.
    Printing,
    /// A print, interrupted.
    Paused,
    /// Something else, such as heating, homing or cancelling.
    Busy,
    /// Nothing until somebody mends it.
    Error,
    /// The host has no connection to its printer.
    Offline,
}

impl Activity {
    /// In a word.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ready => "ready",
            Self::Printing => "printing",
            Self::Paused => "paused",
            Self::Busy => "busy",
            Self::Error => "error",
            Self::Offline => "offline",
        }
    }
}

/// How the last print ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Ended {
    /// To its end.
    Done,
    /// By somebody.
    Cancelled,
    /// By an error.
    Failed,
}

/// How far a print is; what a host does not tell is missing.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Printing {
    /// The file's name.
    pub file: Option<String>,
    /// From 0 to 1.
    pub progress: Option<f64>,
    /// The present layer, from 1.
    pub layer: Option<u32>,
    /// Number of layers.
    pub layers: Option<u32>,
    /// Seconds since its start.
    pub passed_s: Option<f64>,
    /// Seconds to its end.
    pub left_s: Option<f64>,
}

/// What a printer does, and how far it is.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HostState {
    /// What it does.
    pub activity: Activity,
    /// The same in the host's own words.
    pub message: String,
    /// The present print, or the last one.
    pub printing: Printing,
    /// How the last print ended, where it has.
    pub ended: Option<Ended>,
}

/// A file on a host.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Stored {
    /// Size in bytes.
    pub bytes: Option<u64>,
    /// SHA-1 in hexadecimal digits, where the host tells it.
    pub sha1: Option<String>,
}

impl Stored {
    /// Whether it is the file that was sent, as far as can be told; `None`: the host tells nothing.
    pub(super) fn matches(&self, payload: &Payload) -> Option<bool> {
        let bytes = self.bytes.map(|bytes| bytes == payload.bytes);
        let sha1 = self.sha1.as_ref().map(|sha1| sha1.eq_ignore_ascii_case(&payload.sha1));
        match (bytes, sha1) {
            (None, None) => None,
            _ => Some(bytes != Some(false) && sha1 != Some(false)),
        }
    }
}

/// A print host, whatever its interface.
///
/// Requests that change nothing are repeated within the [`Patience`] while connections break; the others are made once.
pub trait PrintHost: Send {
    /// How it is called here.
    fn name(&self) -> &str;

    /// How long it is waited for.
    fn patience(&self) -> &Patience;

    /// Who it is.
    fn about(&self) -> Result<About, SendError>;

    /// What it does.
    fn state(&self) -> Result<HostState, SendError>;

    /// Free space in bytes, where it tells.
    fn free_bytes(&self) -> Result<Option<u64>, SendError>;

    /// A file by its name.
    fn stored(&self, file: &str) -> Result<Option<Stored>, SendError>;

    /// Whether a stored file, which is another than the one that was sent, has all of its commands: a host may write into
    /// files.
    fn has_commands(&self, _file: &str, _payload: &Payload) -> Result<bool, SendError> {
        Ok(false)
    }

    /// Sends a file, without starting it. Returns the name under which it is stored.
    ///
    /// # Errors
    /// Among others: a file of this name exists, and `replace` is false, where the interface can refuse that itself.
    fn upload(
        &self,
        file: &str,
        payload: &Payload,
        replace: bool,
        told: &mut dyn FnMut(u64),
    ) -> Result<String, SendError>;

    /// Asks once for the start of a stored file.
    fn start(&self, file: &str) -> Result<(), SendError>;
}
