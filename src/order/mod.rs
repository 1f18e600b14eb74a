//! Finds the order, direction and entry of every path of a layer.

pub mod matching;
mod problem;

pub use problem::{Item, Problem, Run, Sequence, Shape, Visit};
