//! Profiles: TOML as written (with `inherits`), or configurations of other slicers, resolved and validated once into
//! [`Settings`].
//!
//! Sources take effect in this order: the embedded `default`, each `--profile` in turn (what it inherits
//! first), each `--set` in turn. The later one wins, key by key; where each value came from is kept.

mod conflicts;
mod derived;
mod dump;
mod embedded;
mod error;
mod heights;
mod import;
mod resolve;
mod schema;
mod script;
mod settings;
mod sizes;
mod source;
mod suggest;

pub use derived::strand_area_mm2;
pub use dump::{dump_json, dump_toml, reference};
pub use embedded::{EMBEDDED, EmbeddedProfile, ProfileKind, find as embedded};
pub use error::{Origin, Problem, ProfileError};
pub use heights::{heights_from_lines, layer_heights};
pub use import::import_page;
pub use resolve::{Override, Resolved, resolve};
pub use schema::{Field, Kind, Section, field, keys};
pub(crate) use script::one_line;
pub use script::{PLACEHOLDERS, PrintBounds, expand};
pub use settings::*;
pub use sizes::thumbnail_sizes;
pub use source::text;
