//! Files of all kinds → objects, each a repaired mesh.

mod format;
mod formats;
mod load;
mod obj;
mod polygon;
mod stl;
mod threemf;
mod words;

pub use load::{Model, from_bytes, load, load_objects, objects_from_bytes};
pub(crate) use load::{load_watched, objects_watched};
pub(crate) use threemf::Parts;
