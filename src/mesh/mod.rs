//! Triangle meshes: from a file to a repaired, indexed [`Mesh`].
//!
//! [`load`] reads what users have and repairs what can be repaired without guessing; a [`MeshReport`] says what
//! was found and done. [`Transform`] scales, turns and moves.

mod agree;
mod doubts;
mod edges;
mod error;
mod format;
mod formats;
mod gaps;
mod holes;
mod load;
mod measure;
mod obj;
mod outside;
mod pairs;
mod repair;
mod report;
mod sheets;
mod stl;
mod surface;
mod threemf;
mod transform;
pub(crate) mod units;
mod walls;
mod weld;
mod words;

pub use doubts::Doubt;
pub use error::{Location, MeshError};
pub use load::{Model, from_bytes, load, load_objects, objects_from_bytes};
pub use report::{MeshReport, Repair};
pub use surface::Mesh;
pub use transform::{Transform, TransformError};

pub(crate) use edges::NO_TWIN;
pub(crate) use load::load_watched;
pub(crate) use measure::facet_measures;
