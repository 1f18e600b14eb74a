//! Ordered paths → typed moves: travel, retraction, extrusion amounts, speeds, cooling.

mod moves;

pub use moves::{LayerMoves, Move};
