//! See `cases::obj`.
//!
//!     cargo +nightly fuzz run obj

#![no_main]

#[path = "../cases/mod.rs"]
mod cases;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| cases::obj(bytes));
