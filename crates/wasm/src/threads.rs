//! Several threads, where instances of the module share their memory: each is a worker of the caller's. See [`crate`].

use std::sync::{Mutex, PoisonError};

use rayon::{ThreadBuilder, ThreadPoolBuilder};
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;

/// Threads that no worker has begun yet.
static THREADS: Mutex<Vec<ThreadBuilder>> = Mutex::new(Vec::new());

/// Divides what this thread does from now on among so many threads, of which it is one. The memory that instances for the
/// others are made with; each calls [`help`]. Nothing waits for them.
#[wasm_bindgen]
pub fn share(threads: usize) -> JsValue {
    let keep = |thread| {
        THREADS.lock().unwrap_or_else(PoisonError::into_inner).push(thread);
        Ok(())
    };
    let pool = ThreadPoolBuilder::new().num_threads(threads).use_current_thread().spawn_handler(keep).build();
    // It is there as long as the module is.
    std::mem::forget(pool.expect("threads that nothing has to start"));
    wasm_bindgen::memory()
}

/// Is one of the threads, until the worker ends.
#[wasm_bindgen]
pub fn help() {
    let thread = THREADS.lock().unwrap_or_else(PoisonError::into_inner).pop();
    if let Some(thread) = thread {
        thread.run();
    }
}
