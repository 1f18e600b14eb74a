//! Triangle meshes: from a file to a repaired, indexed [`Mesh`].
//!
//! [`load`] reads what users have and repairs what can be repaired without guessing; a [`MeshReport`] says what
//! was found and done. [`Transform`] scales, turns and moves.

mod display;
mod edges;
mod effect;
mod error;
mod materials;
mod measure;
mod package;
mod paint;
mod read;
mod repair;
mod report;
mod surface;
mod transform;
pub(crate) mod units;
mod weld;

pub use effect::{Effect, SavedSettings, Words};
pub use error::{Location, MeshError};
pub use materials::Materials;
pub use paint::{Paint, PaintedFacet, Wish};
pub use read::{Model, from_bytes, load, load_objects, objects_from_bytes};
pub use repair::Doubt;
pub use report::{MeshReport, Repair};
pub use surface::{Mesh, Modifier};
pub use transform::{Transform, TransformError};
pub use units::{UNITS, UnitHint};

pub(crate) use edges::NO_TWIN;
pub(crate) use measure::facet_measures;
pub(crate) use package::{PackageItem, PackageObject, write_package};
pub(crate) use read::{Parts, load_watched, objects_watched};
pub(crate) use transform::quarter_turned;
