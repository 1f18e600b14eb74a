//! See `cases::stl`.
//!
//!     cargo +nightly fuzz run stl

#![no_main]

#[path = "../cases/mod.rs"]
mod cases;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| cases::stl(bytes));
