//! Precedence as groups of items that stay together, for strategies to build upon.

use std::ops::Range;

use super::options::Scope;
use super::{Problem, Run};
use pathwright_geometry::Point;

/// The items of a problem in groups that are drawn without interruption: its runs, or under `layer` scope
/// everything of one stage. Groups are numbered by (stage, island, rank), so that a group's number is above
/// those of all groups that must come before it; runs of equal rank in one island come in the order of their index.
#[derive(Clone, Debug)]
pub struct Groups {
    /// Items of each group, ascending.
    pub items: Vec<Vec<u32>>,
    /// Group of each item.
    pub of: Vec<u32>,
    /// Stage and unit of each group.
    pub positions: Vec<GroupPosition>,
    /// Whether the groups of a unit are consecutive (`island` scope).
    pub whole_units: bool,
}

/// Where a group stands in the precedence.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct GroupPosition {
    /// All groups of a stage come before all of the next.
    pub stage: u32,
    /// The groups of one island in one stage, which come by ascending number; ascending over all stages.
    pub unit: u32,
}

impl Groups {
    /// Sorts a problem's items into groups. O(n + r log r) for n items and r runs.
    pub fn new(problem: &Problem) -> Self {
        let layer = problem.scope == Scope::Layer;
        let key = |(run, r): (usize, &Run)| {
            if layer { (r.stage, 0, 0, 0) } else { (r.stage, r.island, r.rank, run) }
        };
        let key_of_run: Vec<_> = problem.runs.iter().enumerate().map(key).collect();
        let mut keys: Vec<_> = problem.items.iter().map(|item| key_of_run[item.run as usize]).collect();
        keys.sort_unstable();
        keys.dedup();
        let mut positions: Vec<GroupPosition> = Vec::with_capacity(keys.len());
        for (group, &(stage, island, ..)) in keys.iter().enumerate() {
            let unit = match positions.last() {
                Some(last) if (keys[group - 1].0, keys[group - 1].1) == (stage, island) => last.unit,
                Some(last) => last.unit + 1,
                None => 0,
            };
            positions.push(GroupPosition { stage, unit });
        }
        // A run without items is no group, and nothing asks for it.
        let group_of_run: Vec<u32> =
            key_of_run.iter().map(|key| keys.binary_search(key).unwrap_or(usize::MAX) as u32).collect();
        let of: Vec<u32> = problem.items.iter().map(|item| group_of_run[item.run as usize]).collect();
        let mut items = vec![Vec::new(); keys.len()];
        for (item, &group) in of.iter().enumerate() {
            items[group as usize].push(item as u32);
        }
        Self { items, of, positions, whole_units: problem.scope == Scope::Island }
    }

    /// The positions of each stage's groups, in their order.
    pub fn stages(&self) -> impl Iterator<Item = &[GroupPosition]> {
        self.positions.chunk_by(|a, b| a.stage == b.stage)
    }

    /// The group that must come after this one in its unit, if there is one.
    pub fn next_in_unit(&self, group: u32) -> Option<u32> {
        let next = group + 1;
        let unit = |group: u32| self.positions.get(group as usize).map(|at| at.unit);
        (unit(next) == unit(group)).then_some(next)
    }

    /// The group that must come before this one in its unit, if there is one.
    pub fn previous_in_unit(&self, group: u32) -> Option<u32> {
        group.checked_sub(1).filter(|&previous| self.next_in_unit(previous) == Some(group))
    }
}

/// Which groups may be begun next, while a walk is built from its start.
///
/// Every group is reported once, as it becomes available: O(groups) over a whole walk.
#[derive(Debug)]
pub struct Frontier<'a> {
    pub groups: &'a Groups,
    /// First group of the next stage.
    next_stage: usize,
    /// One past the last group.
    end: usize,
    left_in_stage: usize,
}

impl<'a> Frontier<'a> {
    /// Before the first group; the second value lists the groups that are available at once.
    pub fn new(groups: &'a Groups) -> (Self, Vec<u32>) {
        Self::within(groups, 0..groups.items.len())
    }

    /// The same of some stages, whose groups these are.
    pub fn within(groups: &'a Groups, stages: Range<usize>) -> (Self, Vec<u32>) {
        let mut frontier = Self { groups, next_stage: stages.start, end: stages.end, left_in_stage: 0 };
        let available = frontier.begin_stage();
        (frontier, available)
    }

    /// Marks an available group as drawn and returns the groups that become available by it.
    pub fn take(&mut self, group: u32) -> Vec<u32> {
        self.left_in_stage -= 1;
        if self.left_in_stage == 0 {
            return self.begin_stage();
        }
        self.groups.next_in_unit(group).into_iter().collect()
    }

    fn begin_stage(&mut self) -> Vec<u32> {
        let (from, positions) = (self.next_stage, &self.groups.positions[..self.end]);
        let Some(stage) = positions.get(from).map(|at| at.stage) else { return Vec::new() };
        let to = from + positions[from..].partition_point(|at| at.stage == stage);
        (self.next_stage, self.left_in_stage) = (to, to - from);
        let first_of_unit =
            |&group: &usize| group == from || positions[group].unit != positions[group - 1].unit;
        (from..to).filter(first_of_unit).map(|group| group as u32).collect()
    }
}

/// Every point at which an item that may come first can be entered.
pub fn first_points<'a>(problem: &'a Problem) -> impl Iterator<Item = Point> + use<'a> {
    let groups = Groups::new(problem);
    let (_, available) = Frontier::new(&groups);
    let items: Vec<u32> =
        available.iter().flat_map(|&group| &groups.items[group as usize]).copied().collect();
    items.into_iter().flat_map(|item| problem.items[item as usize].shape.entries()).copied()
}
