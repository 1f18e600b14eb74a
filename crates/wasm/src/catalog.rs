//! What there is to choose from.

use pathwright::job::catalog::{Profile, Schema};
use pathwright::profile::converted;
use serde_json::json;
use wasm_bindgen::prelude::wasm_bindgen;

use crate::error::{Fault, Result};

/// The version of the library.
#[wasm_bindgen]
pub fn version() -> String {
    env!("CARGO_PKG_VERSION").to_owned()
}

/// Every setting with its meaning, range, unit and default, as JSON.
#[wasm_bindgen]
pub fn schema() -> String {
    json!(Schema::known()).to_string()
}

/// The built-in profiles, as JSON.
#[wasm_bindgen]
pub fn profiles() -> String {
    json!(Profile::built_in()).to_string()
}

/// Another slicer's configuration as a profile (TOML).
#[wasm_bindgen]
pub fn convert(name: &str, text: &str) -> Result<String> {
    converted(name, text).map_err(Fault::settings)
}
