//! Text → tree.

mod expression;
mod scanner;
mod script;

pub use script::{condition, script};
