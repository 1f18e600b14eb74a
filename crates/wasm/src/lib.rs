//! Pathwright as WebAssembly: what the page without a server and the npm package call, in a worker of theirs.
//!
//! Values go over as JSON, bytes as bytes. There is one thread, and no unwinding: a run is cancelled by ending its worker, and a
//! mistake of this library ends the module, of which a new instance must be made.

mod catalog;
mod error;
mod finished;
mod hosts;
mod models;
mod order;
mod presets;
mod session;
mod told;
