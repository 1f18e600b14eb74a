//! Pieces of text.

/// Part of a block's text.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Slice {
    pub start: u32,
    pub len: u32,
}

impl Slice {
    pub fn is_empty(self) -> bool {
        self.len == 0
    }

    pub fn of(self, text: &[u8]) -> &[u8] {
        &text[self.start as usize..(self.start + self.len) as usize]
    }
}
