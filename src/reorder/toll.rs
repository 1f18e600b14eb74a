//! What ways cost, and which blocks of a file are worth another order.

use std::ops::{Add, AddAssign};

/// Way without extrusion, and how often filament is pulled back on it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Toll {
    /// Length, mm.
    pub travel_mm: f64,
    /// Retractions.
    pub pulls: usize,
}

impl Toll {
    /// One number for both, a retraction being worth so many millimetres.
    pub fn score(self, retraction_mm: f64) -> f64 {
        self.travel_mm + retraction_mm * self.pulls as f64
    }

    /// Whether neither is above another's.
    pub fn within(self, other: Self) -> bool {
        self.travel_mm <= other.travel_mm && self.pulls <= other.pulls
    }
}

impl Add for Toll {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { travel_mm: self.travel_mm + other.travel_mm, pulls: self.pulls + other.pulls }
    }
}

impl AddAssign for Toll {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

/// What a block comes to in its old order (0) and in its new one (1).
#[derive(Clone, Copy, Debug, Default)]
pub struct Options {
    /// From its first path on.
    pub inside: [Toll; 2],
    /// Up to its first path: by the order of the block before, then by its own.
    pub junction: [[Toll; 2]; 2],
    /// Whether there is a new order.
    pub changed: bool,
}

/// Shares of what a retraction is worth that are tried, one after the other.
const WEIGHTS: [f64; 13] = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0, 0.5, 0.25, 0.125, 0.0625, 0.0];

/// Which of consecutive blocks get their new order: as little travel and as few retractions as can be, a retraction being
/// worth so many millimetres, but neither more travel nor more retractions than `limit`. A retraction is given other
/// values (Lagrangian relaxation) until both are below the limit, or else until neither is above it. `None`
/// where even that is not found.
pub fn choose(options: &[Options], limit: Toll, retraction_mm: f64) -> Option<Vec<bool>> {
    let mut found = None;
    for weight in WEIGHTS {
        let (chosen, toll) = cheapest(options, weight * retraction_mm);
        if toll.within(limit) {
            if toll.travel_mm < limit.travel_mm && toll.pulls < limit.pulls {
                return Some(chosen);
            }
            found = found.or(Some(chosen));
        }
    }
    found
}

/// The choice of least score, and its toll: a shortest path through two options for each block. O(blocks).
fn cheapest(options: &[Options], retraction_mm: f64) -> (Vec<bool>, Toll) {
    // For each block and option, the option of the block before on the cheapest way to it.
    let mut from: Vec<[bool; 2]> = Vec::with_capacity(options.len());
    let mut best = [Some(Toll::default()), None];
    let cheaper = |a: Option<Toll>, b: Option<Toll>| match (a, b) {
        (Some(a), Some(b)) => b.score(retraction_mm) < a.score(retraction_mm),
        (a, _) => a.is_none(),
    };
    for block in options {
        let mut next = [None; 2];
        let mut came = [false; 2];
        for new in 0..1 + usize::from(block.changed) {
            let by =
                [0, 1].map(|old| best[old].map(|t: Toll| t + block.junction[old][new] + block.inside[new]));
            came[new] = cheaper(by[0], by[1]);
            next[new] = by[usize::from(came[new])];
        }
        from.push(came);
        best = next;
    }
    let mut at = cheaper(best[0], best[1]);
    let toll = best[usize::from(at)].unwrap_or_default();
    let mut chosen = vec![false; options.len()];
    for (chosen, came) in chosen.iter_mut().zip(&from).rev() {
        *chosen = at;
        at = came[usize::from(at)];
    }
    (chosen, toll)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn toll(travel_mm: f64, pulls: usize) -> Toll {
        Toll { travel_mm, pulls }
    }

    /// Blocks whose insides cost `old` and `new`, and whose junctions cost nothing.
    fn blocks(inside: &[[Toll; 2]]) -> Vec<Options> {
        inside.iter().map(|&inside| Options { inside, changed: true, ..Options::default() }).collect()
    }

    #[test]
    fn a_block_may_retract_more_where_another_one_saves_it() {
        let blocks = blocks(&[[toll(100.0, 5), toll(50.0, 6)], [toll(100.0, 5), toll(90.0, 2)]]);
        assert_eq!(choose(&blocks, toll(200.0, 10), 7.5), Some(vec![true, true]));
    }

    #[test]
    fn retractions_are_not_paid_for_with_more_than_there_were() {
        let inside = [
            [toll(100.0, 5), toll(50.0, 7)],
            [toll(100.0, 5), toll(80.0, 6)],
            [toll(99.0, 5), toll(98.0, 3)],
        ];
        assert_eq!(choose(&blocks(&inside), toll(299.0, 15), 7.5), Some(vec![false, false, true]));
    }

    #[test]
    fn what_a_new_order_costs_the_next_block_counts() {
        let mut blocks = blocks(&[[toll(100.0, 1), toll(95.0, 1)], [toll(50.0, 1), toll(50.0, 1)]]);
        blocks[1].changed = false;
        blocks[1].junction[1] = [toll(20.0, 0); 2];
        assert_eq!(choose(&blocks, toll(150.0, 2), 7.5), Some(vec![false, false]));
    }

    #[test]
    fn nothing_is_chosen_where_all_is_dearer() {
        let mut blocks = blocks(&[[toll(10.0, 1), toll(20.0, 1)]]);
        blocks[0].junction[0] = [toll(5.0, 0); 2];
        assert_eq!(choose(&blocks, toll(10.0, 1), 7.5), None);
    }
}
