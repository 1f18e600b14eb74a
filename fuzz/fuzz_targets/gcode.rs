//! See `cases::gcode`.
//!
//!     cargo +nightly fuzz run gcode

#![no_main]

#[path = "../cases/mod.rs"]
mod cases;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| cases::gcode(bytes));
