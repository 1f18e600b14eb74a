//! Any bytes through the reader of finished G-code, and through the proof, which must find a file equal to itself.
//!
//!     cargo +nightly fuzz run reorder corpus

#![no_main]

use libfuzzer_sys::fuzz_target;
use pathwright::reorder::{Blocks, verify};

fuzz_target!(|bytes: &[u8]| {
    let mut blocks = Blocks::new(bytes);
    while let Ok(Some(block)) = blocks.read() {
        assert!(block.bytes() <= bytes.len());
    }
    if let Ok(verdict) = verify(bytes, bytes) {
        assert!(verdict.is_ok());
    }
});
