//! Disjoint sets.

/// Disjoint sets of the numbers below a count, with path halving (Tarjan & van Leeuwen 1984,
/// <https://doi.org/10.1145/62.2160>). A set is named by its least member.
pub(crate) struct Parts(Vec<u32>);

impl Parts {
    pub(crate) fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    pub(crate) fn find(&mut self, mut v: u32) -> u32 {
        while self.0[v as usize] != v {
            self.0[v as usize] = self.0[self.0[v as usize] as usize];
            v = self.0[v as usize];
        }
        v
    }

    /// Unites two sets; whether they were apart.
    pub(crate) fn join(&mut self, u: u32, v: u32) -> bool {
        if u == v {
            return false;
        }
        let (u, v) = (self.find(u), self.find(v));
        self.0[u.max(v) as usize] = u.min(v);
        u != v
    }
}
