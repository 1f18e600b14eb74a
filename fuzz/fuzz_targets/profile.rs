//! See `cases::profile`.
//!
//!     cargo +nightly fuzz run profile

#![no_main]

#[path = "../cases/mod.rs"]
mod cases;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| cases::profile(bytes));
