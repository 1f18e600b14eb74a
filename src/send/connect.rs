//! From what is known about a host to a host that can be talked to.

use super::client::Client;
use super::duet_board::Board;
use super::duet_computer::Computer;
use super::entry::{HostEntry, HostKind, Secret};
use super::error::{Cause, SendError, Step};
use super::host::PrintHost;
use super::moonraker::Moonraker;
use super::octoprint::OctoPrint;
use super::patience::Patience;
use super::prusalink::PrusaLink;

/// A host that can be talked to. Only a Duet is asked anything at this point: which of its two interfaces it has.
///
/// # Errors
/// What is known about it makes no sense (a key file that is not there), or it does not answer.
pub fn connect(entry: &HostEntry, patience: Patience) -> Result<Box<dyn PrintHost>, SendError> {
    let key = entry.key.read().map_err(|(message, advice)| {
        SendError::new(&entry.name, Step::Configure, Cause::Settings, message, advice)
    })?;
    let client = Client::new(entry, patience)?;
    let with_key = |client: Client, key: Option<Secret>| {
        if let Some(key) = key {
            client.set_header("X-Api-Key", key);
        }
        client
    };
    Ok(match entry.kind {
        HostKind::OctoPrint => Box::new(OctoPrint::new(with_key(client, key))),
        HostKind::Moonraker => Box::new(Moonraker::new(with_key(client, key))),
        HostKind::PrusaLink => {
            // With a user it is a password, which the digest keeps to itself.
            let client = match (&entry.user, key) {
                (Some(user), Some(password)) => client.login(user, password),
                (_, key) => with_key(client, key),
            };
            Box::new(PrusaLink::new(client, entry.storage.clone()))
        }
        HostKind::Duet => duet(client, key)?,
    })
}

/// Logs in: to a board of its own, or to the single-board computer in front of it, which has no `rr_connect`.
fn duet(client: Client, password: Option<Secret>) -> Result<Box<dyn PrintHost>, SendError> {
    let client = match &password {
        Some(password) => client.hide(password),
        None => client,
    };
    match Board::connect(client, password.clone())? {
        Ok(board) => Ok(Box::new(board)),
        Err(client) => Ok(Box::new(Computer::connect(client, password)?)),
    }
}
