//! The service as a process, over HTTP: what it promises, what it survives, what it refuses.

mod attacks;
mod http;
mod interface;
mod jobs;
mod load;
mod server;
mod tls;
