//! Short lists of what lies near each place.

use super::super::precedence::Groups;
use super::super::{Problem, Shape};
use super::grid::{Found, Grid};
use super::walk::NONE;
use crate::geom::Point;

/// Length of the lists. Longer ones find a little more per step, and cost more than that (on layers of six slicers'
/// G-code: 8 against 6 gained 0.6 % per kick and lost it again to fewer kicks).
pub const NEAR: usize = 8;
/// Vertices of a loop from which gaps for it are looked for, and how many nodes from each.
const SAMPLES: usize = 6;
const NEAR_SAMPLE: usize = 3;

/// Nodes near a node, nearest first; of a loop, its even node. The rest is [`NONE`].
pub type Near = [u32; NEAR];

/// The nearest nodes of the same group for every entry, found when first asked for.
#[derive(Debug)]
pub struct Neighbours {
    grids: Vec<Grid>,
    /// First entry of each item.
    first: Vec<u32>,
    /// Index of the list of each entry, plus one.
    slot: Vec<u32>,
    lists: Vec<Near>,
    /// For each loop, entries and nodes near them, once asked for.
    sites: Vec<Option<Vec<(u32, u32)>>>,
    found: Vec<Found>,
}

impl Neighbours {
    /// Nothing found yet.
    pub fn new(problem: &Problem, groups: &Groups) -> Self {
        let mut first = Vec::with_capacity(problem.items.len());
        let mut entries = 0u32;
        for item in &problem.items {
            first.push(entries);
            entries += match item.shape {
                Shape::Open(_) => 2,
                Shape::Loop(vertices) => vertices.len() as u32,
            };
        }
        Self {
            grids: groups.items.iter().map(|items| Grid::new(problem, items)).collect(),
            first,
            slot: vec![0; entries as usize],
            lists: Vec::with_capacity(2 * problem.items.len()),
            sites: vec![None; problem.items.len()],
            found: Vec::with_capacity(NEAR + 1),
        }
    }

    /// What lies near an entry of an item, within its group.
    #[inline]
    pub fn of(&mut self, problem: &Problem, group: u32, item: u32, entry: u32) -> Near {
        let at = (self.first[item as usize] + entry) as usize;
        if self.slot[at] == 0 {
            let list = self.near(group, problem.items[item as usize].ends(entry).0, item);
            self.lists.push(list);
            self.slot[at] = self.lists.len() as u32;
        }
        self.lists[self.slot[at] as usize - 1]
    }

    /// What of a group lies near a point, one item excepted.
    pub fn near(&mut self, group: u32, point: Point, except: u32) -> Near {
        let mut near = [NONE; NEAR];
        self.grids[group as usize].nearest(point, except, NEAR, &mut self.found);
        for (near, found) in near.iter_mut().zip(&self.found) {
            *near = found.1;
        }
        near
    }

    /// Entries of a loop, spread evenly, with nodes of its group that lie near them; borrowed until given back by
    /// [`Self::put_sites`].
    pub fn take_sites(&mut self, problem: &Problem, group: u32, item: u32) -> Vec<(u32, u32)> {
        if let Some(sites) = self.sites[item as usize].take() {
            return sites;
        }
        let Shape::Loop(vertices) = problem.items[item as usize].shape else { return Vec::new() };
        let mut sites = Vec::with_capacity(SAMPLES * NEAR_SAMPLE);
        for entry in (0..vertices.len()).step_by(vertices.len().div_ceil(SAMPLES)) {
            self.grids[group as usize].nearest(vertices[entry], item, NEAR_SAMPLE, &mut self.found);
            sites.extend(self.found.iter().map(|&(_, node)| (entry as u32, node)));
        }
        sites
    }

    /// Keeps a loop's sites for the next time.
    pub fn put_sites(&mut self, item: u32, sites: Vec<(u32, u32)>) {
        self.sites[item as usize] = Some(sites);
    }
}
