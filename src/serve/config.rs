//! What a server is told when it starts.

use std::net::SocketAddr;
use std::path::PathBuf;

use super::limits::Limits;
use super::tokens::Tokens;
use crate::presets::Library;

/// Certificate and key, as PEM.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TlsFiles {
    /// Certificates, the server's own first.
    pub cert: PathBuf,
    /// Private key.
    pub key: PathBuf,
}

/// What a server is told when it starts.
#[derive(Debug)]
pub struct Config {
    /// Address and port; port 0: any that is free.
    pub listen: SocketAddr,
    /// Folder of jobs and results; made where it is not there.
    pub data: PathBuf,
    /// Who may use it; without tokens everybody who reaches it.
    pub tokens: Tokens,
    /// Names by which it is called, besides `localhost` and addresses.
    pub hosts: Vec<String>,
    /// Encryption; none: that is the proxy's.
    pub tls: Option<TlsFiles>,
    /// What it does at most.
    pub limits: Limits,
    /// Presets of other slicers.
    pub presets: Library,
    /// Threads that slice one job; 0: as many as the machine has cores.
    pub threads: usize,
    /// Jobs sliced at once; 0: one for every two cores.
    pub jobs_at_once: usize,
    /// Models that the page opens at its start: names and contents.
    pub opened: Vec<(String, Vec<u8>)>,
}
