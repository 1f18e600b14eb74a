//! Finds the order, direction and entry of every path of a layer.

mod as_sliced;
pub mod bound;
mod chain;
mod check;
mod christofides;
mod christofides_open;
pub mod compare;
mod cost;
mod detours;
mod entries;
mod greedy;
mod index;
mod layer;
pub mod matching;
mod nearest;
mod optimized;
mod parts;
mod precedence;
mod problem;
mod seam;
mod strategy;

pub use as_sliced::AsSliced;
pub use chain::{Chain, chunk_len};
pub use check::{Fault, check};
pub use christofides::Christofides;
pub use christofides_open::ChristofidesOpen;
pub use cost::{Cost, TravelTime, evaluate};
pub use detours::{DetourRule, Detours};
pub use greedy::Greedy;
pub use layer::{LayerProblem, ends_on_path};
pub use nearest::Nearest;
pub use optimized::Optimized;
pub(crate) use parts::Parts;
pub use problem::{Item, Problem, Run, Sequence, Shape, Visit};
pub use seam::{Pins, SeamRule, enter_nearest};
pub use strategy::{Known, Strategy, strategy};
