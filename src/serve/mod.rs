//! The service and the page: HTTP around the library (feature `serve`).
//!
//! [`serve`] answers until it is told to end. [`router`] is the list of everything there is; each part (`jobs`, `sessions`, …)
//! makes a router with a state of its own, and all share `Shared`: limits, presets, the threads that slice.

mod assets;
mod auth;
mod body;
mod catalog;
mod config;
mod description;
mod error;
mod extract;
mod guard;
mod jobs;
mod limits;
mod listen;
mod metrics;
mod monitoring;
mod names;
mod page;
mod print_hosts;
mod refused;
mod router;
mod serving;
mod sessions;
mod shared;
mod streams;
mod tokens;
mod tools;

pub use config::{Config, TlsFiles};
pub use limits::Limits;
pub use page::{page_files, page_index};
pub use serving::{Ending, ServeError, serve};
pub use tokens::Tokens;
