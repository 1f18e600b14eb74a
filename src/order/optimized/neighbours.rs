//! Short lists of what lies near each place.

use super::super::index::{Entry, Index};
use super::super::{Problem, Shape};
use super::walk::NONE;

/// Length of the lists. In the plane, 8 to 10 quadrant-free neighbours lose next to nothing against more
/// (Johnson & McGeoch 1997, "The traveling salesman problem: a case study in local optimization").
pub const NEAR: usize = 8;

/// Nodes near a node, nearest first; of a loop, its even node. The rest is [`NONE`].
pub type Near = [u32; NEAR];

/// The nearest items of the same group for every entry, found when first asked for.
#[derive(Debug)]
pub struct Neighbours {
    /// First entry of each item.
    first: Vec<u32>,
    /// Index of the list of each entry, plus one.
    slot: Vec<u32>,
    lists: Vec<Near>,
    found: Vec<Entry>,
}

impl Neighbours {
    /// Empty lists for all entries.
    pub fn new(problem: &Problem) -> Self {
        let mut first = Vec::with_capacity(problem.items.len());
        let mut entries = 0u32;
        for item in &problem.items {
            first.push(entries);
            entries += match item.shape {
                Shape::Open(_) => 2,
                Shape::Loop(vertices) => vertices.len() as u32,
            };
        }
        Self { first, slot: vec![0; entries as usize], lists: Vec::new(), found: Vec::new() }
    }

    /// What lies near an entry of an item, within its group.
    pub fn of(&mut self, problem: &Problem, index: &Index, group: u32, item: u32, entry: u32) -> Near {
        let at = (self.first[item as usize] + entry) as usize;
        if self.slot[at] == 0 {
            let point = problem.items[item as usize].ends(entry).0;
            let list = self.near(problem, index, group, point, item);
            self.lists.push(list);
            self.slot[at] = self.lists.len() as u32;
        }
        self.lists[self.slot[at] as usize - 1]
    }

    /// What of a group lies near a point, one item excepted.
    pub fn near(
        &mut self,
        problem: &Problem,
        index: &Index,
        group: u32,
        point: crate::geom::Point,
        except: u32,
    ) -> Near {
        let mut near = [NONE; NEAR];
        index.nearest_items(group, point, except, NEAR, &mut self.found);
        for (near, entry) in near.iter_mut().zip(&self.found) {
            *near = match problem.items[entry.item as usize].shape {
                Shape::Open(_) => 2 * entry.item + entry.entry,
                Shape::Loop(_) => 2 * entry.item,
            };
        }
        near
    }
}
