//! The service and the page: HTTP around the library (feature `serve`).
//!
//! [`serve`] answers until it is told to end. [`router`] is the list of everything there is; each part (`jobs`, `sessions`, …)
//! makes a router with a state of its own, and all share `Shared`: limits, presets, the threads that slice.

mod assets;
mod auth;
mod body;
mod catalog;
mod config;
mod error;
mod extract;
mod guard;
mod health;
mod jobs;
mod limits;
mod listen;
mod metrics;
mod page;
mod router;
mod serving;
mod sessions;
mod shared;
mod streams;
mod tools;

pub use auth::Tokens;
pub use config::{Config, TlsFiles};
pub use limits::Limits;
pub use serving::{Ending, ServeError, serve};
