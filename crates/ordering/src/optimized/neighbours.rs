//! Short lists of what lies near each position.

use rustc_hash::FxHashMap;

use super::super::precedence::Groups;
use super::super::{Cost, Problem};
use super::end::NONE;
use super::grid::{Found, Grid};
use pathwright_geometry::{Point, to_mm};

/// Length of the lists. On layers of nine G-code files, 8 instead of 6 ended the first descent 1 % lower for a tenth
/// more time; 5 lost another 1 %.
pub const NEAR: usize = 8;

/// A node near a position.
#[derive(Clone, Copy, Debug)]
pub struct Near {
    /// The node; of a loop, its even node. [`NONE`] and an infinite cost follow the last one.
    pub node: u32,
    /// Its entry; of a loop, some vertex that is near.
    pub entry: u32,
    /// The least that a link to it can cost, wherever a loop is entered (according to its samples).
    pub least: f64,
}

/// Nodes near a position, nearest first.
pub type List = [Near; NEAR];
const EMPTY: List = [Near { node: NONE, entry: 0, least: f64::INFINITY }; NEAR];

/// The nearest nodes of the same group for every entry, found on first use.
#[derive(Debug)]
pub struct Neighbours {
    grids: Vec<Grid>,
    cost: Cost,
    /// First entry of each item.
    first: Vec<u32>,
    /// Index of the list of each entry; 0 if it has none yet.
    slot: Vec<u32>,
    /// Index of the list of entries in groups other than their own.
    others: FxHashMap<(u32, u32), u32>,
    /// The lists; the first is that of the last position that is no entry of the group.
    lists: Vec<List>,
}

impl Neighbours {
    /// Nothing found yet.
    pub fn new(problem: &Problem, groups: &Groups, cost: Cost) -> Self {
        let mut first = Vec::with_capacity(problem.items.len());
        let mut entries = 0u32;
        for item in &problem.items {
            first.push(entries);
            entries += item.shape.entries().len() as u32;
        }
        Self {
            grids: groups.items.iter().map(|items| Grid::new(problem, items)).collect(),
            cost,
            first,
            slot: vec![0; entries as usize],
            others: FxHashMap::default(),
            lists: {
                let mut lists = Vec::with_capacity(1 + 5 * problem.items.len());
                lists.push(EMPTY);
                lists
            },
        }
    }

    /// The list of what lies near an entry of an item, within its group.
    #[inline]
    pub fn of(&mut self, problem: &Problem, group: u32, item: u32, entry: u32) -> usize {
        let at = (self.first[item as usize] + entry) as usize;
        if self.slot[at] == 0 {
            let list = self.find(group, problem.items[item as usize].ends(entry).0, item);
            self.slot[at] = self.lists.len() as u32;
            self.lists.push(list);
        }
        self.slot[at] as usize
    }

    /// The nodes near an entry of an item, in a group other than its own.
    pub fn in_other(&mut self, problem: &Problem, group: u32, item: u32, entry: u32) -> usize {
        let at = (self.first[item as usize] + entry, group);
        if let Some(&list) = self.others.get(&at) {
            return list as usize;
        }
        let list = self.find(group, problem.items[item as usize].ends(entry).0, NONE);
        self.others.insert(at, self.lists.len() as u32);
        self.lists.push(list);
        self.lists.len() - 1
    }

    /// The nodes of a group near a position outside it, valid until the next call; empty if the position is free.
    pub fn near(&mut self, group: u32, [x, y]: [f64; 2]) -> usize {
        self.lists[0] = if x.is_nan() { EMPTY } else { self.find(group, Point::from_mm(x, y), NONE) };
        0
    }

    /// A list.
    #[inline]
    pub fn list(&self, list: usize) -> &List {
        &self.lists[list]
    }

    /// A position in a list.
    #[inline]
    pub fn get(&self, list: usize, at: usize) -> Near {
        self.lists[list][at]
    }

    fn find(&self, group: u32, point: Point, except: u32) -> List {
        let mut list = EMPTY;
        let found = self.grids[group as usize].nearest::<NEAR>(point, except);
        for (near, (distance2, node, entry)) in list.iter_mut().zip(found) {
            let least = self.cost.least((distance2 as f64).sqrt() * to_mm(1));
            *near = Near { node, entry, least };
        }
        list
    }

    /// The entry of a group nearest to a position, among those wanted (by node and entry).
    pub fn nearest_wanted(&self, group: u32, p: Point, wanted: impl Fn(u32, u32) -> bool) -> Option<Found> {
        self.grids[group as usize].nearest_wanted(p, wanted)
    }
}
