//! What the search works on.

use std::collections::VecDeque;

use super::super::entries::EntrySearch;
use super::super::index::Index;
use super::super::precedence::Groups;
use super::super::{Problem, Watch};
use super::gaps::Gaps;
use super::neighbours::Neighbours;
use super::vicinity::Vicinity;
use super::walk::Walk;

/// A walk and what is needed to improve it.
pub struct Search<'a> {
    pub(super) problem: &'a Problem<'a>,
    pub(super) groups: &'a Groups,
    pub(super) walk: Walk<'a>,
    pub(super) neighbours: Neighbours,
    /// Exchanges move at most this many items.
    pub(super) reach: u32,
    pub(super) vicinity: Vicinity<'a>,
    /// Stages of so few items are searched thoroughly: neighbouring loops are entered again together, and kicked more at a time.
    pub(super) few: usize,
    /// Whether all items are on the walk. Before that, stages are not fitted to each other: the search would pay for it again
    /// with every kick.
    pub(super) complete: bool,
    pub(super) queue: VecDeque<u32>,
    pub(super) queued: Vec<bool>,
    pub(super) watch: Watch<'a>,
    /// The work after which who watches looks again.
    pub(super) next_look: u64,
    /// The gaps that a block may move to.
    pub(super) gaps: Gaps,
    /// Buffers of the search for entries.
    pub(super) entry_search: EntrySearch,
    /// Entries of all items, for [`Nearest`](super::super::Nearest).
    pub(super) index: Option<Index<'a>>,
}
