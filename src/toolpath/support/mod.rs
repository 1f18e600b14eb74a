//! Supports under overhangs.
//!
//! Where a layer hangs over the one below is found on exact outlines ([`overhang`]); where supports stand is decided
//! on cells of 0.4 mm ([`bitmap`]), from the top down, as columns
//! ([`columns`]) or trees ([`tree`]); their beads are laid on exact outlines again
//! ([`beads`]), each layer by itself, and begin where they rest on something ([`rest`]).

mod beads;
mod bitmap;
mod bridge;
mod columns;
mod overhang;
mod rest;
mod trace;
mod tree;
mod within;

pub use beads::{BeadSpec, Outlines, lay};
pub use bitmap::{Bitmap, Grid};
pub use columns::{Cells, ColumnSpec, stand};
pub use overhang::{Overhang, ROUGH_MM, Slab, SupportModifiers, find, lasting, window};
pub use rest::Ground;
pub use trace::trace;
pub use tree::{Disc, grow, outline};
pub(crate) use within::Within;

/// Side of a cell: a bead's width.
pub const CELL_MM: f64 = 0.4;
