//! Profiles: TOML as written (with `inherits`) resolved and validated once into [`Settings`].

mod settings;

pub use settings::*;
