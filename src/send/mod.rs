//! Print hosts: finished G-code is sent to a printer's computer, checked there, started and followed.
//!
//! Hosts are named in a file of the user (`Hosts`). `connect`, or [`connect_by`] where there is no network of this machine, gives a
//! [`PrintHost`], one for each documented HTTP interface:
//! OctoPrint, Moonraker, PrusaLink and RepRapFirmware's two. [`deliver`] uploads within a patience and compares what is
//! stored there with what was sent; [`start`] asks for a start at most once; [`follow`] waits for the end.

mod altered;
mod client;
mod connect;
mod deliver;
#[cfg(feature = "send")]
mod digest;
mod duet;
mod duet_board;
mod duet_computer;
mod entry;
mod error;
mod examine;
mod follow;
mod form;
mod host;
#[cfg(feature = "send")]
mod hosts;
mod moonraker;
#[cfg(feature = "send")]
mod network;
mod octoprint;
mod patience;
mod payload;
mod print;
mod prusalink;
mod said;
#[cfg(feature = "send")]
mod tls;
mod transport;

#[cfg(feature = "send")]
pub use connect::connect;
pub use connect::connect_by;
pub use deliver::{Delivery, deliver, start};
pub use entry::{HostEntry, HostKind, KeySource, Secret};
pub use error::{Cause, SendError, Step};
pub use examine::{FileFacts, check, examine};
pub use follow::{Outcome, follow};
pub use host::{About, Activity, Ended, HostState, PrintHost, Printing, Stored};
#[cfg(feature = "send")]
pub use hosts::{Hosts, HostsError};
pub use patience::Patience;
pub use payload::Payload;
pub use print::{Sent, Wanted, print};
pub use transport::{Broken, Incoming, Outgoing, Transport};
