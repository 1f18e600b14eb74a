//! What is told while something goes on: to one function for the whole module, as there is one thread.

use std::cell::RefCell;
use std::time::Duration;

use js_sys::{Date, Function, Uint8Array};
use serde_json::Value;
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;

thread_local! {
    static LISTENER: RefCell<Option<Function>> = const { RefCell::new(None) };
}

/// Calls a function with name, JSON and sometimes bytes of whatever happens from now on.
#[wasm_bindgen]
pub fn listen(listener: Function) {
    LISTENER.set(Some(listener));
}

/// Tells what has happened. The listener's own errors are its own business.
pub fn tell(name: &str, value: &Value, bytes: Option<&[u8]>) {
    let Some(listener) = LISTENER.with_borrow(Clone::clone) else { return };
    let bytes = bytes.map_or(JsValue::UNDEFINED, |bytes| Uint8Array::from(bytes).into());
    let _ = listener.call3(&JsValue::NULL, &name.into(), &value.to_string().into(), &bytes);
}

/// The time since a fixed moment.
pub fn clock() -> Duration {
    Duration::from_secs_f64(Date::now() / 1000.0)
}

/// A mistake of the library is told before the module ends.
#[wasm_bindgen(start)]
fn begin() {
    std::panic::set_hook(Box::new(|panic| tell("panic", &panic.to_string().into(), None)));
}
