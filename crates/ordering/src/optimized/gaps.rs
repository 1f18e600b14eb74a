//! Gaps between groups that a block may move to.

/// Gaps that a block may move to: a buffer from search to search.
#[derive(Debug, Default)]
pub struct Gaps {
    pub(super) found: Vec<u32>,
    /// For each gap, in which search it was tried last.
    tried: Vec<u32>,
    search: u32,
}

impl Gaps {
    /// Begins a search among so many gaps.
    pub(super) fn clear(&mut self, count: u32) {
        self.found.clear();
        self.search = self.search.wrapping_add(1);
        if self.tried.len() < count as usize || self.search == 0 {
            self.tried = vec![0; count as usize];
            self.search = 1;
        }
    }

    /// Whether a gap was tried before in this search; from now on it is.
    pub(super) fn is_tried(&mut self, gap: u32) -> bool {
        std::mem::replace(&mut self.tried[gap as usize], self.search) == self.search
    }
}
