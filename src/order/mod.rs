//! Finds the order, direction and entry of every path of a layer.

mod problem;

pub use problem::{Item, Problem, Run, Sequence, Shape, Visit};
