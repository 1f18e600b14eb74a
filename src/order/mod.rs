//! Orders the layers of a print: their paths as problems for `pathwright-ordering`, seams, and layers chained.

mod chain;
pub mod compare;
pub mod compare_tools;
mod layer;
mod options;
mod seam;
mod stack;
mod straight_on;

pub use chain::{Chain, chunk_len};
pub use layer::{LayerProblem, PathOrder, PathVisit, ends_on_path};
pub use options::{CostKind, OrderSettings, SeamPosition, SeamSettings, ToolOrder};
pub use ordering::*;
pub use seam::{Pins, SeamRule, enter_nearest};
pub use straight_on::Corners;
