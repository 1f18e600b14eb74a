//! See `cases::threemf`.
//!
//!     cargo +nightly fuzz run threemf

#![no_main]

#[path = "../cases/mod.rs"]
mod cases;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| cases::threemf(bytes));
