//! Other slicers' G-code in another order: what is printed stays, the travels between change.
//!
//! A file is read as [`Block`]s: lines that stay where they are, then paths on one layer that may change places. What
//! the file does between two paths is learned as its [`RetractionStyle`]. A block becomes a problem for [`crate::order`]
//! ([`Ordering`]) and text again ([`write()`]): strokes as they were, and between them links as they were, or new
//! travels in the file's retraction style that do not cross outer [`Walls`]. In the end [`verify`] compares the two files.

mod block;
mod directed;
mod islands;
mod lines;
mod link_cost;
mod monotonic;
mod problem;
mod reader;
mod retraction;
mod slice;
mod state;
mod ticks;
mod times;
mod verify;
mod walls;
mod writer;

pub use block::Block;
pub use directed::forwards;
pub use link_cost::{LinkCost, Options, choose};
pub use problem::{Ordering, Pick};
pub use reader::Blocks;
pub use retraction::{Learner, RetractionStyle};
pub use times::{Times, has_times};
pub use verify::{Inventory, Proof, Readback, verify};
pub use walls::Walls;
pub use writer::{TIME_PADDING, Written, end, junction, write};
