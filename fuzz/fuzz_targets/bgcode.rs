//! See `cases::bgcode`.
//!
//!     cargo +nightly fuzz run bgcode

#![no_main]

#[path = "../../tests/support/cases/mod.rs"]
mod cases;
#[path = "../../tests/support/toolpath_plan.rs"]
mod toolpath_plan;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| cases::bgcode(bytes));
