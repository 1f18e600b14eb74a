//! Tree → text.

mod assign;
mod context;
mod functions;
mod nodes;
mod operators;
mod value;

pub use nodes::{flag, text};
