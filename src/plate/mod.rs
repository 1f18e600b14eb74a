//! The plate: which models of the files stand where on the bed.
//!
//! A [`Layout`] is what a file holds, its models at their positions; [`place()`] arranges layouts, or the bodies in them.

mod area;
mod arrange;
mod error;
mod faces;
mod file;
mod group;
mod layout;
mod near;
mod objects;
mod options;
mod orient;
mod pack;
mod place;
mod placement;
mod settle;
mod silhouette;
mod slivers;
mod stand;

pub use error::PlacementError;
pub use faces::{Face, faces};
pub use file::{Model, name_of, read_file};
pub use layout::{Item, Layout};
pub use objects::{Object, Plate};
pub use options::{BedOrigin, BedSettings, BedShape, PlateSettings, PrintSettings, Sequence};
pub use orient::orient;
pub(crate) use orient::upright;
pub use place::place;
pub use placement::{Arrange, Placement};
pub use slivers::Line;
pub use stand::stand;
