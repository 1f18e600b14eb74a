//! Errors as JavaScript has them.

use js_sys::JSON;
use pathwright::Error;
use pathwright::live::Failure;
use serde_json::{Value, json};
use wasm_bindgen::JsValue;

/// An error: its kind, message, and where they apply file, place, object and key.
pub struct Fault(Value);

/// The value, or what JavaScript throws.
pub type Result<T> = std::result::Result<T, Fault>;

impl Fault {
    /// The caller's mistake.
    pub fn usage(message: impl ToString) -> Self {
        Self(json!({ "kind": "usage", "message": message.to_string() }))
    }

    /// A mistake in settings.
    pub fn settings(message: impl ToString) -> Self {
        Self(json!({ "kind": "settings", "message": message.to_string() }))
    }
}

impl From<Error> for Fault {
    fn from(error: Error) -> Self {
        Self(json!({
            "kind": error.kind(), "message": error.to_string(), "file": error.file(), "place": error.place(),
            "object": error.object(), "key": error.key(),
        }))
    }
}

impl From<Failure> for Fault {
    fn from(failure: Failure) -> Self {
        match failure {
            Failure::Job(error) => error.into(),
            Failure::Limit(message) => Self(json!({ "kind": "limit", "message": message })),
            missing => Self(json!({ "kind": "not_found", "message": missing.to_string() })),
        }
    }
}

impl From<Fault> for JsValue {
    fn from(fault: Fault) -> Self {
        let text = fault.0.to_string();
        JSON::parse(&text).unwrap_or_else(|_| text.into())
    }
}
