//! Sections → paths: walls, solid shells, infill, skirt and brim.

mod path;

pub use path::{Island, LayerPaths, Path, Role, Width};
