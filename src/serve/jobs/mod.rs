//! Jobs: accepted, kept on the disk, sliced in turn, and given back.
//!
//! [`index`] decides, [`store`] and [`files`] keep, [`queue`] slices; the others are what is asked over HTTP.

mod accept;
mod budget;
mod delivery;
mod events;
mod files;
mod hub;
mod index;
mod queue;
mod record;
mod render;
mod results;
mod routes;
mod run;
mod store;
mod upload;

pub use hub::Jobs;
pub use queue::Runners;
pub use routes::router;
pub use upload::{Received, receive};
