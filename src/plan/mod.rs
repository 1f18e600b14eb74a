//! Plans a plate: sections of all layers, and what depends on several of them (shells, supports, infill, the spiral), so that
//! each layer's paths can be made by itself.

pub(crate) mod blocks;
mod contact;
pub(crate) mod floating;
mod floor;
pub(crate) mod flush;
mod infill;
mod modifiers;
mod overlaps;
mod paint;
pub(crate) mod parts;
mod piece;
pub(crate) mod planners;
pub(crate) mod priming;
mod rounded;
pub(crate) mod sections;
pub(crate) mod shield;
mod slivers;
pub(crate) mod spiral;
pub(crate) mod styles;
pub(crate) mod supports;
mod thin;
pub(crate) mod tool_order;
pub(crate) mod tower;
mod wishes;
