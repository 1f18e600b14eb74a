//! Results that were found before, by what they depend on.

use std::collections::HashMap;
use std::fmt;
use std::hash::{Hash, Hasher};
use std::sync::{Arc, Mutex, PoisonError};

use rustc_hash::FxBuildHasher;

use super::Polygon;

/// Multiplied with, bits spread over a word: 2⁶⁴ over the golden ratio.
const SPREAD: u64 = 0x9E37_79B9_7F4A_7C15;

/// Polygons and numbers that results depend on; hashed once.
#[derive(Clone, PartialEq, Eq)]
pub struct Shape {
    hash: u64,
    polygons: Vec<Polygon>,
    numbers: Vec<u64>,
}

impl Shape {
    /// Of some polygons and numbers.
    pub fn new<'a>(polygons: impl IntoIterator<Item = &'a Polygon>, numbers: impl Into<Vec<u64>>) -> Self {
        let (polygons, numbers) = (polygons.into_iter().cloned().collect::<Vec<_>>(), numbers.into());
        let spread = |hash: u64, word: u64| (hash.rotate_left(5) ^ word).wrapping_mul(SPREAD);
        let vertices = polygons.iter().flat_map(Polygon::rings).flatten();
        let hash =
            vertices.fold(0, |hash, p| spread(hash, u64::from(p.x as u32) << 32 | u64::from(p.y as u32)));
        let hash = numbers.iter().fold(hash, |hash, &number| spread(hash, number));
        Self { hash, polygons, numbers }
    }
}

impl Hash for Shape {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.hash.hash(state);
    }
}

/// Results by what they depend on. What is known never makes a difference to a result, but to the time that it takes.
///
/// Results of this weight are kept, and as many again of those used before them.
pub struct Known<V> {
    most: usize,
    generations: Mutex<Generations<V>>,
}

struct Generations<V> {
    /// With their weights.
    recent: HashMap<Shape, (Arc<V>, usize), FxBuildHasher>,
    older: HashMap<Shape, (Arc<V>, usize), FxBuildHasher>,
    /// Of the recent ones.
    weight: usize,
}

impl<V> Known<V> {
    /// Nothing is known yet. Results up to this weight are kept.
    pub fn new(most: usize) -> Self {
        let generations = Generations { recent: HashMap::default(), older: HashMap::default(), weight: 0 };
        Self { most, generations: Mutex::new(generations) }
    }

    /// A result, made unless it is known. A function weighs it.
    pub fn of(&self, key: Shape, weigh: impl FnOnce(&V) -> usize, make: impl FnOnce() -> V) -> Arc<V> {
        if let Some(known) = self.look(|generations| generations.find(&key, self.most)) {
            return known;
        }
        let made = Arc::new(make());
        let entry = (Arc::clone(&made), weigh(&made));
        self.look(|generations| generations.add(key, entry, self.most));
        made
    }

    /// How many are known.
    pub fn count(&self) -> usize {
        self.look(|generations| generations.recent.len() + generations.older.len())
    }

    fn look<T>(&self, look: impl FnOnce(&mut Generations<V>) -> T) -> T {
        look(&mut self.generations.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// A copy knows nothing yet.
impl<V> Clone for Known<V> {
    fn clone(&self) -> Self {
        Self::new(self.most)
    }
}

impl<V> fmt::Debug for Known<V> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Known").field("count", &self.count()).finish()
    }
}

impl<V> Generations<V> {
    fn find(&mut self, key: &Shape, most: usize) -> Option<Arc<V>> {
        if let Some((known, _)) = self.recent.get(key) {
            return Some(Arc::clone(known));
        }
        let (key, entry) = self.older.remove_entry(key)?;
        let known = Arc::clone(&entry.0);
        self.add(key, entry, most);
        Some(known)
    }

    fn add(&mut self, key: Shape, entry: (Arc<V>, usize), most: usize) {
        if self.weight > most {
            self.older = std::mem::take(&mut self.recent);
            self.weight = 0;
        }
        self.weight += entry.1;
        self.recent.insert(key, entry);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Point;

    fn square(side: i32) -> Polygon {
        let outer = [(0, 0), (side, 0), (side, side), (0, side)].map(|(x, y)| Point::new(x, y)).to_vec();
        Polygon { outer, holes: Vec::new() }
    }

    #[test]
    fn results_are_made_once_of_each_shape_and_numbers() {
        let known = Known::new(100);
        let mut made = Vec::new();
        for (side, number) in [(1, 1), (1, 1), (2, 1), (1, 2), (2, 1)] {
            let shape = Shape::new([&square(side)], [number]);
            let got = known.of(
                shape,
                |_| 1,
                || {
                    made.push((side, number));
                    (side, number)
                },
            );
            assert_eq!(*got, (side, number));
        }
        assert_eq!(made, [(1, 1), (2, 1), (1, 2)]);
    }

    #[test]
    fn only_so_many_are_kept_and_those_in_use_stay() {
        let known = Known::new(100);
        let mut made = 0;
        for side in 1..1000 {
            known.of(Shape::new([&square(side)], []), |_| 3, || side);
            known.of(
                Shape::new([&square(0)], []),
                |_| 3,
                || {
                    made += 1;
                    0
                },
            );
        }
        assert!(known.count() <= 70, "{}", known.count());
        assert_eq!(made, 1);
    }
}
