//! See `cases::threemf`.
//!
//!     cargo +nightly fuzz run threemf

#![no_main]

#[path = "../../tests/support/cases/mod.rs"]
mod cases;
#[path = "../../tests/support/toolpath_plan.rs"]
mod toolpath_plan;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| cases::threemf(bytes));
