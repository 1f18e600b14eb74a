//! A tree over boxes that stay as they are, for "which of them touch this one".

use super::{Bounds, Point, Polygon, Region};

/// Boxes under a node of the tree.
const FAN: usize = 8;

/// Boxes, packed into a tree by the order of their middles along a Z-curve. Building is O(n log n), asking O(log n) for boxes
/// that lie apart.
#[derive(Clone, Debug, Default)]
pub struct Boxes {
    /// In the order of the curve, with their numbers.
    leaves: Vec<(Bounds, usize)>,
    /// What spans each [`FAN`] of the level before, from those over the leaves up.
    levels: Vec<Vec<Bounds>>,
}

impl Boxes {
    /// Sorts boxes; each keeps its number.
    pub fn new(boxes: impl IntoIterator<Item = Bounds>) -> Self {
        let mut leaves: Vec<(Bounds, usize)> = boxes.into_iter().zip(0..).collect();
        let mut levels: Vec<Vec<Bounds>> = Vec::new();
        if leaves.len() > FAN {
            let all = spanned(leaves.iter().map(|(bounds, _)| bounds));
            leaves.sort_by_cached_key(|(bounds, number)| (along_curve(bounds, &all), *number));
            levels.push(leaves.chunks(FAN).map(|part| spanned(part.iter().map(|(b, _)| b))).collect());
            while let Some(level) = levels.last().filter(|level| level.len() > FAN) {
                let over = level.chunks(FAN).map(|part| spanned(part.iter())).collect();
                levels.push(over);
            }
        }
        Self { leaves, levels }
    }

    /// Those of a region's polygons.
    pub fn of(region: &Region) -> Self {
        Self::new(region.polygons().iter().map(Polygon::bounds))
    }

    /// Whether a region whose boxes these are has exactly this polygon.
    pub fn find(&self, region: &Region, polygon: &Polygon) -> bool {
        self.touching(&polygon.bounds()).into_iter().any(|i| region.polygons()[i] == *polygon)
    }

    /// Numbers of the boxes that touch a box, ascending.
    pub fn touching(&self, bounds: &Bounds) -> Vec<usize> {
        let mut found = Vec::new();
        self.each_under(self.levels.len(), 0, bounds, &mut found);
        found.sort_unstable();
        found
    }

    /// Numbers of the boxes that hold a point, ascending.
    pub fn holding(&self, p: Point) -> Vec<usize> {
        self.touching(&Bounds::spanned(p, p))
    }

    /// Those under the nodes of a level below `level` that are the children of its node `node`.
    fn each_under(&self, level: usize, node: usize, bounds: &Bounds, found: &mut Vec<usize>) {
        let first = node * FAN;
        let Some(below) = level.checked_sub(1) else {
            let end = self.leaves.len().min(first + FAN);
            let leaves = self.leaves[first..end].iter().filter(|(own, _)| own.touches(bounds));
            return found.extend(leaves.map(|(_, number)| *number));
        };
        let nodes = &self.levels[below];
        for (child, own) in nodes.iter().enumerate().skip(first).take(FAN) {
            if own.touches(bounds) {
                self.each_under(below, child, bounds, found);
            }
        }
    }
}

/// What spans some boxes, at least one.
fn spanned<'a>(boxes: impl Iterator<Item = &'a Bounds>) -> Bounds {
    boxes.copied().reduce(|a, b| a.joined(&b)).unwrap_or_default()
}

/// Where the middle of a box lies along a Z-curve over all of them.
fn along_curve(bounds: &Bounds, all: &Bounds) -> u32 {
    let cell = |min: i32, max: i32, from: i32, to: i32| {
        let (middle, size) =
            ((i64::from(min) + i64::from(max)) / 2 - i64::from(from), i64::from(to) - i64::from(from) + 1);
        (middle * (1 << 16) / size) as u32
    };
    // A bit between each two.
    let spread = |value: u32| {
        let steps = [(8, 0x00ff_00ff), (4, 0x0f0f_0f0f), (2, 0x3333_3333), (1, 0x5555_5555)];
        steps.into_iter().fold(value, |value, (by, kept)| (value | value << by) & kept)
    };
    let x = cell(bounds.min.x, bounds.max.x, all.min.x, all.max.x);
    let y = cell(bounds.min.y, bounds.max.y, all.min.y, all.max.y);
    spread(x) | spread(y) << 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Random;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn exactly_those_that_touch_are_found(seed in 0..1000u64, count in 0..300usize) {
            let mut random = Random::new(seed);
            let mut make = |most: u32| {
                let [x, y, w, h] = [2000, 2000, most, most].map(|n| random.below(n) as i32 - 1000);
                let corner = Point::new(x, y);
                Bounds::spanned(corner, Point::new(x + (w + 1000) / 4, y + (h + 1000) / 4))
            };
            let all: Vec<Bounds> = (0..count).map(|k| make(if k % 20 == 0 { 3000 } else { 100 })).collect();
            let boxes = Boxes::new(all.iter().copied());
            for _ in 0..20 {
                let asked = make(200);
                let touched: Vec<usize> = (0..count).filter(|&i| all[i].touches(&asked)).collect();
                prop_assert_eq!(boxes.touching(&asked), touched);
                let held: Vec<usize> = (0..count).filter(|&i| all[i].holds(asked.min)).collect();
                prop_assert_eq!(boxes.holding(asked.min), held);
            }
        }
    }
}
