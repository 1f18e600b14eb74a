//! The positions of groups and the groups near each.

use pathwright_geometry::real;

use super::super::index::Index;
use super::super::precedence::Groups;
use super::super::{Problem, Shape};

/// The groups of one stage, and the gaps between which they lie; the last group is excluded.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stage {
    pub(super) groups: (u32, u32),
    pub(super) gaps: (u32, u32),
}

/// The positions of groups and the groups near each.
#[derive(Debug)]
pub struct Vicinity<'a> {
    /// Of all items, once a near group was requested.
    pub(super) index: Option<Index<'a>>,
    /// The groups of one stage that are open there.
    pub(super) open: (u32, u32),
    /// The stage of each group.
    pub(super) stage: Vec<Stage>,
    /// Near groups of each group, once requested.
    pub(super) near: Vec<Option<Vec<u32>>>,
    /// Centre and radius of a disc, in millimetres, that holds all entries of each lone loop.
    pub(super) disc: Vec<Option<([f64; 2], f64)>>,
}

impl Vicinity<'_> {
    /// What is known at once.
    pub fn new(problem: &Problem, groups: &Groups) -> Self {
        let mut stage = Vec::with_capacity(groups.items.len());
        let mut gap = 1;
        for positions in groups.stages() {
            let (first, begin) = (stage.len(), gap);
            let end = first + positions.len();
            gap += groups.items[first..end].iter().map(|items| items.len() as u32).sum::<u32>();
            let all = Stage { groups: (first as u32, end as u32), gaps: (begin, gap) };
            stage.extend(positions.iter().map(|_| all));
        }
        let disc = |items: &Vec<u32>| match (items.as_slice(), problem.items[items[0] as usize].shape) {
            ([_], Shape::Loop(vertices)) => {
                let sum = vertices.iter().map(|v| v.mm()).fold([0.0; 2], |s, p| [s[0] + p[0], s[1] + p[1]]);
                let center = sum.map(|sum| sum / vertices.len() as f64);
                let from_center = |v: &pathwright_geometry::Point| {
                    let [x, y] = v.mm();
                    real::hypot(x - center[0], y - center[1])
                };
                Some((center, vertices.iter().map(from_center).fold(0.0, f64::max)))
            }
            _ => None,
        };
        Self {
            index: None,
            open: (0, 0),
            stage,
            near: vec![None; groups.items.len()],
            disc: groups.items.iter().map(disc).collect(),
        }
    }
}
