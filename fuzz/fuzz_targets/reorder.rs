//! Any bytes through the reader of finished G-code, through the writer, every path in another place, and through the
//! proof, which must find a file equal to itself.
//!
//!     cargo +nightly fuzz run reorder corpus

#![no_main]

use libfuzzer_sys::fuzz_target;
use pathwright::order::PathVisit;
use pathwright::profile::{Scope, SeamPosition};
use pathwright::reorder::{Block, Blocks, Learner, Ordering, Walls, end, verify, write};

fuzz_target!(|bytes: &[u8]| {
    let mut reader = Blocks::new(bytes);
    let (mut blocks, mut learner): (Vec<Block>, _) = (Vec::new(), Learner::default());
    while let Ok(Some(block)) = reader.read() {
        assert!(block.bytes() <= bytes.len());
        learner.learn(&block);
        blocks.push(block);
    }
    let style = learner.style().unwrap_or_default();
    let mut at = blocks.first().map_or([0; 2], Block::start);
    let mut written = Vec::new();
    for (index, block) in blocks.iter().enumerate() {
        let ordering = Ordering::new(block, index, SeamPosition::Free, Scope::Feature);
        let items = (0..ordering.layer.paths.len() as u32).rev();
        let visits: Vec<PathVisit> = items.map(|item| PathVisit { path: item, entry: item % 2 }).collect();
        let picks = ordering.picks(block, &visits);
        let walls = Walls::new(std::iter::once(block));
        written.extend(write(block, &picks, at, &style, &walls).bytes);
        at = end(block, &picks);
    }
    // Whatever it says, it must come to an end.
    let _ = verify(bytes, written.as_slice());
    if let Ok(verdict) = verify(bytes, bytes) {
        assert!(verdict.is_ok());
    }
});
