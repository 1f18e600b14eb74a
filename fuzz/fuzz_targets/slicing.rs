//! See `cases::slicing`.
//!
//!     cargo +nightly fuzz run slicing

#![no_main]

#[path = "../cases/mod.rs"]
mod cases;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| cases::slicing(bytes));
