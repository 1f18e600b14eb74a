//! The plate: which models of the files stand where on the bed.
//!
//! A [`Layout`] is what a file holds, its models at their positions; [`place()`] arranges layouts, or the bodies in them.

mod area;
mod arrange;
mod error;
mod file;
mod group;
mod layout;
mod objects;
mod options;
mod orient;
mod pack;
mod place;
mod silhouette;
mod slivers;

pub use error::PlacementError;
pub use file::{Model, name_of, read_file};
pub use layout::{Item, Layout};
pub use objects::{Object, Plate};
pub use options::{BedOrigin, BedSettings, BedShape, PlateSettings, PrintSettings, Sequence};
pub use orient::orient;
pub use place::{Arrange, Placement, place};
pub use slivers::Line;
