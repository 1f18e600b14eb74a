//! From what is known about a host to a host that can be talked to.

use super::client::Client;
#[cfg(feature = "send")]
use super::digest::Digest;
use super::duet_board::Board;
use super::duet_computer::Computer;
use super::entry::{HostEntry, HostKind, Secret};
use super::error::{Cause, SendError, Step};
use super::host::PrintHost;
use super::moonraker::Moonraker;
#[cfg(feature = "send")]
use super::network::Network;
use super::octoprint::OctoPrint;
use super::patience::Patience;
use super::prusalink::PrusaLink;
use super::transport::Transport;

/// A host that can be talked to by this machine's network. Only a Duet is asked anything at this point: which of its two interfaces it has.
///
/// # Errors
/// What is known about it makes no sense (a key file that is not there), or it does not answer.
#[cfg(feature = "send")]
pub fn connect(entry: &HostEntry, patience: Patience) -> Result<Box<dyn PrintHost>, SendError> {
    let network = Network::new(entry, patience.silence)
        .map_err(|(message, advice)| misconfigured(entry, message, advice.to_owned()))?;
    connect_by(entry, patience, Box::new(network))
}

/// The same by another way than this machine's network.
///
/// # Errors
/// As `connect`.
pub fn connect_by(
    entry: &HostEntry,
    patience: Patience,
    transport: Box<dyn Transport>,
) -> Result<Box<dyn PrintHost>, SendError> {
    let key = entry.key.read().map_err(|(message, advice)| misconfigured(entry, message, advice))?;
    let client = Client::new(entry, patience, transport);
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
                #[cfg(feature = "send")]
                (Some(user), Some(password)) => client.hide(&password).login(Digest::new(user, password)),
                (_, key) => with_key(client, key),
            };
            Box::new(PrusaLink::new(client, entry.storage.clone()))
        }
        HostKind::Duet => duet(client, key)?,
    })
}

fn misconfigured(entry: &HostEntry, message: String, advice: String) -> SendError {
    SendError::new(&entry.name, Step::Configure, Cause::Settings, message, advice)
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
