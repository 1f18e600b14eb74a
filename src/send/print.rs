//! All that becomes of a print for a host: compared with the printer, sent, started.

use serde::{Deserialize, Serialize};

use super::deliver::{deliver, start};
use super::entry::HostEntry;
use super::error::SendError;
use super::examine::{FileFacts, check, examine, unreadable};
use super::host::PrintHost;
use super::payload::Payload;

/// What is to be done with a print.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Wanted {
    /// Its name there.
    pub file: String,
    /// Start it, too.
    #[serde(default)]
    pub start: bool,
    /// Overwrite a file of this name.
    #[serde(default)]
    pub replace: bool,
}

/// What has been done with a print.
#[derive(Clone, Debug, Serialize)]
pub struct Sent {
    /// The name under which it is stored.
    pub name: String,
    /// Whether the host told that what it stored is what was sent.
    pub is_verified: bool,
    /// What may be a mistake.
    pub warnings: Vec<String>,
}

/// Compares a print with a host's printer, sends it, and starts it where that is wanted; `told` is told how many percent are sent.
///
/// # Errors
/// It is for another printer, or has an error; or what the host answers.
pub fn print(
    host: &dyn PrintHost,
    entry: &HostEntry,
    payload: &Payload,
    wanted: &Wanted,
    told: &mut dyn FnMut(u64),
) -> Result<Sent, SendError> {
    let about = host.about()?;
    let facts = FileFacts::read(payload).map_err(|error| unreadable(&entry.name, payload, &error))?;
    let mut warnings = examine(&entry.name, entry.kind, &about, &facts)?;
    check(&entry.name, payload, &about, None)?;
    let mut before = None;
    let sent = deliver(host, payload, &wanted.file, wanted.replace, &mut |done| {
        let percent = Some(100 * done / payload.bytes.max(1));
        if percent != before {
            before = percent;
            percent.into_iter().for_each(&mut *told);
        }
    })?;
    if sent.is_altered {
        warnings.push(format!(
            "{} has written into {}; all commands are there, in their order",
            entry.name, sent.name
        ));
    }
    if wanted.start {
        start(host, &sent.name)?;
    }
    Ok(Sent { name: sent.name, is_verified: sent.is_verified, warnings })
}
