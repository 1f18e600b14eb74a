//! Links between terminals.

use super::model::Model;

/// A link between two terminals.
#[derive(Clone, Copy)]
pub(super) struct Link {
    /// In fine units.
    pub(super) cost: i64,
    pub(super) a: u32,
    pub(super) b: u32,
    /// The tie at either end; 0: none.
    pub(super) ties: [u32; 2],
    /// Cuts that hold both ends: a piece of the list of all these.
    pub(super) shared: (u32, u32),
    /// Trees since the last look that used it.
    pub(super) used: u32,
}

impl Link {
    /// The paths that it joins.
    pub(super) fn items(&self, model: &Model) -> [u32; 2] {
        [self.a, self.b].map(|t| model.terminals[t as usize].item)
    }

    /// Its piece of the list of shared cuts.
    pub(super) fn shared<'a>(&self, all: &'a [u32]) -> &'a [u32] {
        &all[self.shared.0 as usize..self.shared.1 as usize]
    }
}
