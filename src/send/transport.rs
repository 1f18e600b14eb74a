//! What carries requests to a host: this machine's network, or what a page has in its place.

use std::io::{self, Read};
use std::time::Duration;

use super::error::Cause;

/// A request on its way.
pub struct Outgoing<'a> {
    /// As HTTP calls it.
    pub method: &'static str,
    /// The whole address.
    pub url: &'a str,
    /// Names and values; the length of the body is not among them.
    pub headers: &'a [(&'static str, String)],
    /// Length of the body, and what it is read from.
    pub body: Option<(u64, &'a mut dyn Read)>,
    /// How long the host may be silent.
    pub silence: Duration,
}

/// An answer, whatever its status.
pub struct Incoming {
    /// As HTTP has it.
    pub status: u16,
    /// Where it sends us.
    pub location: Option<String>,
    /// How it asks for a password.
    pub challenge: Option<String>,
    /// What it says.
    pub body: Box<dyn Read>,
}

/// Why there is no answer, or not all of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Broken {
    /// Why.
    pub cause: Cause,
    /// What happened.
    pub message: String,
    /// What to do about it.
    pub advice: String,
    /// Whether the same may succeed a little later.
    pub is_transient: bool,
    /// Whether the request was never sent.
    pub is_unsent: bool,
}

/// Carries requests, one after the other, and follows no answer elsewhere.
pub trait Transport: Send {
    /// Makes one request.
    ///
    /// # Errors
    /// There is no answer.
    fn exchange(&self, request: Outgoing<'_>) -> Result<Incoming, Broken>;

    /// What it means that an answer cannot be read to its end.
    fn broken(&self, error: io::Error) -> Broken;
}
