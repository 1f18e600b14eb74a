//! Local search with what travels really cost, around the links that are longer than they look.

use super::super::detours::Detours;
use super::state::Search;
use pathwright_geometry::Random;

/// How often those links are found again and kicked.
const ROUNDS: u64 = 8;

impl<'a> Search<'a> {
    /// Makes links inside islands cost their route instead of the straight line.
    pub fn use_detours(&mut self, detours: &'a Detours<'a>) {
        self.walk.use_detours(detours);
    }

    /// Improves a walk around the links that lead round something: it may have been found as if all travels went straight.
    ///
    /// Never more expensive than it was, detours counted.
    pub fn refine(&mut self, steps: u64) {
        self.finish(|walk, gap| walk.is_expensive(gap));
        let mut random = Random::new(self.problem.items.len() as u64);
        // No steps, no rounds.
        for _ in 0..ROUNDS.min(steps) {
            let expensive_items = self.expensive_items();
            if expensive_items.is_empty() {
                break;
            }
            self.iterate_at(&expensive_items, &mut random, expensive_items.len() as u64 * steps / ROUNDS);
        }
    }

    /// Items next to a link whose detour makes it more expensive than the straight line.
    fn expensive_items(&self) -> Vec<u32> {
        (1..=self.walk.len())
            .filter(|&gap| self.walk.is_expensive(gap))
            .map(|gap| self.walk.item_at(gap))
            .collect()
    }

    /// Kicks the walk at some items, each wherever it is by then, until `budget` steps are done.
    fn iterate_at(&mut self, items: &[u32], random: &mut Random, budget: u64) {
        let end = self.walk.work + budget;
        while self.walk.work < end {
            let item = items[random.below(items.len() as u32) as usize];
            self.kick_and_repair(self.walk.position(item), random);
        }
    }
}
