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
    /// One of a kind.
    pub fn of(kind: &str, message: impl ToString) -> Self {
        Self(json!({ "kind": kind, "message": message.to_string() }))
    }

    /// The caller's mistake.
    pub fn usage(message: impl ToString) -> Self {
        Self::of("usage", message)
    }

    /// A mistake in settings.
    pub fn settings(message: impl ToString) -> Self {
        Self::of("settings", message)
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
            Failure::Limit(message) => Self::of("limit", message),
            missing => Self::of("not_found", missing),
        }
    }
}

impl From<Fault> for JsValue {
    fn from(fault: Fault) -> Self {
        let text = fault.0.to_string();
        JSON::parse(&text).unwrap_or_else(|_| text.into())
    }
}
