//! What prints do not call as a rule, which is a module of its own (`xtask/src/split.rs`): loaded when something in it is called.

use wasm_bindgen::prelude::wasm_bindgen;

#[wasm_bindgen]
extern "C" {
    /// Makes an instance of it beside this one.
    #[wasm_bindgen(js_namespace = globalThis, js_name = loadPathwrightRest)]
    fn load();
}

/// Loads it. What was divided calls this.
#[wasm_bindgen]
pub fn load_rest() {
    load();
}
