//! What links cost, and which blocks of a file are worth another order.

use std::ops::{Add, AddAssign};

use geometry::real;

/// Length travelled without extrusion, and the number of retractions on it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LinkCost {
    /// Length, mm.
    pub travel_mm: f64,
    /// Retractions.
    pub retractions: usize,
}

impl LinkCost {
    /// One number for both, a retraction being worth this many millimetres.
    pub fn score(self, retraction_mm: f64) -> f64 {
        self.travel_mm + retraction_mm * self.retractions as f64
    }

    /// Whether neither is above another's.
    pub fn within(self, other: Self) -> bool {
        self.travel_mm <= other.travel_mm && self.retractions <= other.retractions
    }
}

impl Add for LinkCost {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            travel_mm: self.travel_mm + other.travel_mm,
            retractions: self.retractions + other.retractions,
        }
    }
}

impl AddAssign for LinkCost {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

/// The costs of a block in each of several orders, the first being the file's.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// From its first path on.
    pub inside: Vec<LinkCost>,
    /// Up to its first path: by the order of the block before (of the first block there is only one), then by its own.
    pub junction: Vec<Vec<LinkCost>>,
}

/// Multiples of a retraction's cost that are tried in turn: from 1 to 128, then down to 0.
fn weights() -> impl Iterator<Item = f64> {
    let up = (0..=56).map(|step| real::exp2(f64::from(step) / 8.0));
    let down = (1..=32).map(|step| real::exp2(f64::from(-step) / 8.0));
    up.chain(down).chain([0.0])
}

/// One retraction in this many less is a clear gain.
const CLEAR: usize = 200;

/// The order of each of consecutive blocks: as little travel and as few retractions as can be, a retraction being
/// worth this many millimetres, but neither more travel nor more retractions than `limit`. A retraction is given other
/// values (Lagrangian relaxation) until both are clearly below the limit, or else until both are below it, or neither
/// is above it. `None` where even that is not found.
pub fn choose(options: &[Options], limit: LinkCost, retraction_mm: f64) -> Option<Vec<usize>> {
    let (mut below, mut within) = (None, None);
    for weight in weights() {
        let (chosen, cost) = cheapest(options, weight * retraction_mm);
        if cost.within(limit) {
            let fewer = limit.retractions - cost.retractions;
            if cost.travel_mm < limit.travel_mm && fewer > 0 {
                if fewer > limit.retractions / CLEAR {
                    return Some(chosen);
                }
                below = below.or(Some(chosen));
            } else {
                within = within.or(Some(chosen));
            }
        }
    }
    below.or(within)
}

/// The choice of least score, and its cost: a shortest path through the options of block after block. O(blocks · options²).
fn cheapest(options: &[Options], retraction_mm: f64) -> (Vec<usize>, LinkCost) {
    let least = |costs: &mut dyn Iterator<Item = LinkCost>| {
        let score = |cost: &LinkCost| cost.score(retraction_mm);
        let best = costs.enumerate().min_by(|(_, a), (_, b)| score(a).total_cmp(&score(b)));
        best.unwrap_or_default()
    };
    let mut best = vec![LinkCost::default()];
    // For each block and option, the option of the block before on the cheapest path to it.
    let mut came: Vec<Vec<usize>> = Vec::with_capacity(options.len());
    for block in options {
        let to = |new: usize| {
            let (old, cost) =
                least(&mut best.iter().zip(&block.junction).map(|(&cost, junction)| cost + junction[new]));
            (old, cost + block.inside[new])
        };
        let (from, next) = (0..block.inside.len()).map(to).unzip();
        came.push(from);
        best = next;
    }
    let (mut at, cost) = least(&mut best.iter().copied());
    let mut chosen = vec![0; options.len()];
    for (chosen, came) in chosen.iter_mut().zip(&came).rev() {
        *chosen = at;
        at = came[at];
    }
    (chosen, cost)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cost(travel_mm: f64, retractions: usize) -> LinkCost {
        LinkCost { travel_mm, retractions }
    }

    /// Blocks whose insides cost this much, by order, and whose junctions are free.
    fn blocks(inside: &[[LinkCost; 2]]) -> Vec<Options> {
        let block = |(i, inside): (usize, &[LinkCost; 2])| {
            let junction = vec![vec![LinkCost::default(); 2]; if i == 0 { 1 } else { 2 }];
            Options { inside: inside.to_vec(), junction }
        };
        inside.iter().enumerate().map(block).collect()
    }

    #[test]
    fn a_block_may_retract_more_where_another_one_saves_it() {
        let blocks = blocks(&[[cost(100.0, 5), cost(50.0, 6)], [cost(100.0, 5), cost(90.0, 2)]]);
        assert_eq!(choose(&blocks, cost(200.0, 10), 7.5), Some(vec![1, 1]));
    }

    #[test]
    fn retractions_are_not_paid_for_with_more_than_there_were() {
        let kept = [cost(100.0, 5), cost(50.0, 7)];
        let blocks = blocks(&[kept, kept, [cost(100.0, 5), cost(98.0, 3)]]);
        assert_eq!(choose(&blocks, cost(300.0, 15), 7.5), Some(vec![0, 0, 1]));
    }

    #[test]
    fn what_a_new_order_costs_the_next_block_counts() {
        let mut blocks = blocks(&[[cost(100.0, 1), cost(95.0, 1)], [cost(50.0, 1), cost(50.0, 1)]]);
        blocks[1].junction[1] = vec![cost(20.0, 0); 2];
        assert_eq!(choose(&blocks, cost(150.0, 2), 7.5), Some(vec![0, 0]));
    }

    #[test]
    fn nothing_is_chosen_where_all_is_dearer() {
        let mut blocks = blocks(&[[cost(10.0, 1), cost(20.0, 1)]]);
        blocks[0].junction[0] = vec![cost(5.0, 0); 2];
        assert_eq!(choose(&blocks, cost(10.0, 1), 7.5), None);
    }
}
