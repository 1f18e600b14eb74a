//! Pathwright as WebAssembly: what the page without a server and the npm package call, in a worker of theirs.
//!
//! Values go over as JSON, bytes as bytes. There is no unwinding: a run is cancelled by ending its worker, and a mistake of this
//! library ends the module, of which a new instance must be made. It is built for one thread, and with the target feature `atomics` for
//! several.

mod catalog;
mod error;
mod finished;
mod hosts;
mod models;
mod order;
mod presets;
mod rest;
mod session;
#[cfg(target_feature = "atomics")]
mod threads;
mod told;
