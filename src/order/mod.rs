//! Finds the order, direction and entry of every path of a layer.

mod as_sliced;
mod check;
mod christofides;
mod christofides_open;
mod cost;
mod greedy;
mod index;
pub mod matching;
mod nearest;
mod precedence;
mod problem;
mod strategy;

pub use as_sliced::AsSliced;
pub use check::{Fault, check};
pub use christofides::Christofides;
pub use christofides_open::ChristofidesOpen;
pub use cost::{Cost, TravelTime, evaluate};
pub use greedy::Greedy;
pub use nearest::Nearest;
pub use problem::{Item, Problem, Run, Sequence, Shape, Visit};
pub use strategy::{Strategy, strategy};
