//! Groups within which links are a tree.

use super::super::directions::RUNS;
use super::super::model::DEPTHS;
use super::super::relaxation::Relaxation;

/// Families of sibling groups, each joined by as many links as it has siblings, but one.
pub(super) struct Families {
    /// The family that a link of a path belongs to, by depth and path.
    pub(super) of: [Vec<u32>; DEPTHS],
    /// How many links a family has, where the degrees do not tell: not where links have directions,
    pub(super) links: Vec<Option<u32>>,
}

impl Families {
    pub(super) fn new(relaxation: &Relaxation) -> Self {
        let model = relaxation.model;
        let mut families = Self { of: Default::default(), links: Vec::new() };
        for depth in 0..DEPTHS {
            // Family and sibling of each path.
            let place = |(item, groups): (usize, &[u32; 3])| {
                let sibling = groups.get(depth).map_or(item as u32, |&group| group);
                (groups[..depth].to_vec(), sibling)
            };
            let all: Vec<_> = model.bodies.iter().map(|body| &body.groups).enumerate().map(place).collect();
            let mut sorted = all.clone();
            sorted.sort_unstable();
            sorted.dedup();
            let first = families.links.len() as u32;
            let found: Vec<_> = sorted.chunk_by(|a, b| a.0 == b.0).collect();
            let number = |family: &[u32]| first + found.partition_point(|of| of[0].0[..] < *family) as u32;
            families.of[depth] = all.iter().map(|(family, _)| number(family)).collect();
            let has_directions = depth == RUNS && relaxation.directions.is_some();
            let links = found.iter().map(|of| of.len() as u32 - 1);
            families.links.extend(links.map(|links| (links > 0 && !has_directions).then_some(links)));
        }
        // The last has what is left of all links.
        if let Some(last) = families.links.iter().rposition(Option::is_some) {
            families.links[last] = None;
        }
        families
    }
}
