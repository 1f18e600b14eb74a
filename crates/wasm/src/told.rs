//! What is told while something goes on: to one function, that of the thread which was called.

use std::cell::RefCell;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use js_sys::{Date, Function, Uint8Array};
use serde_json::Value;
use wasm_bindgen::prelude::wasm_bindgen;
use wasm_bindgen::{JsValue, throw_str};

thread_local! {
    static LISTENER: RefCell<Option<Function>> = const { RefCell::new(None) };
}

/// Name, JSON and sometimes bytes.
type Told = (String, String, Option<Vec<u8>>);

/// What threads without a listener have told.
static WAITING: Mutex<Vec<Told>> = Mutex::new(Vec::new());

fn waiting() -> MutexGuard<'static, Vec<Told>> {
    WAITING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Calls a function with name, JSON and sometimes bytes of whatever happens from now on.
#[wasm_bindgen]
pub fn listen(listener: Function) {
    LISTENER.set(Some(listener));
}

/// Tells what has happened.
pub fn tell(name: &str, value: &Value, bytes: Option<&[u8]>) {
    let value = value.to_string();
    match LISTENER.with_borrow(Clone::clone) {
        Some(listener) => {
            tell_waiting();
            call(&listener, name, &value, bytes);
        }
        None => waiting().push((name.to_owned(), value, bytes.map(<[u8]>::to_vec))),
    }
}

/// Tells what other threads had to tell.
#[wasm_bindgen]
pub fn tell_waiting() {
    let Some(listener) = LISTENER.with_borrow(Clone::clone) else { return };
    let told = std::mem::take(&mut *waiting());
    for (name, value, bytes) in told {
        call(&listener, &name, &value, bytes.as_deref());
    }
}

/// The listener's own errors are its own business.
fn call(listener: &Function, name: &str, value: &str, bytes: Option<&[u8]>) {
    let bytes = bytes.map_or(JsValue::UNDEFINED, |bytes| Uint8Array::from(bytes).into());
    let _ = listener.call3(&JsValue::NULL, &name.into(), &value.into(), &bytes);
}

/// The time since a fixed moment.
pub fn clock() -> Duration {
    Duration::from_secs_f64(Date::now() / 1000.0)
}

/// A mistake of the library ends the module with its message.
#[wasm_bindgen(start)]
fn begin() {
    std::panic::set_hook(Box::new(|panic| throw_str(&panic.to_string())));
}
