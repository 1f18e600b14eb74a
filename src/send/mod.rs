//! Print hosts: finished G-code is sent to a printer's computer, checked there, started and followed.
//!
//! [`Hosts`] are named in a file of the user. [`connect`] gives a [`PrintHost`], one for each documented HTTP interface:
//! OctoPrint, Moonraker, PrusaLink and RepRapFirmware's two. [`deliver`] uploads within a patience and compares what is
//! stored there with what was sent; [`start`] asks for a start at most once; [`follow`] waits for the end.

mod altered;
mod broken;
mod client;
mod connect;
mod deliver;
mod duet;
mod duet_board;
mod duet_computer;
mod entry;
mod error;
mod examine;
mod follow;
mod form;
mod host;
mod hosts;
mod moonraker;
mod octoprint;
mod patience;
mod payload;
mod prusalink;
mod said;
mod tls;

pub use connect::connect;
pub use deliver::{Delivery, deliver, start};
pub use entry::{HostEntry, HostKind, KeySource, Secret};
pub use error::{Cause, SendError, Step};
pub use examine::{FileFacts, check, examine};
pub use follow::{Outcome, follow};
pub use host::{About, Activity, Ended, HostState, PrintHost, Printing, Stored};
pub use hosts::{Hosts, HostsError};
pub use patience::Patience;
pub use payload::Payload;
