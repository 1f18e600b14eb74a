//! Sessions of pages: plates that are sliced as they change.

mod hub;
mod results;
mod routes;
mod stream;

pub(super) use routes::router;
