//! The walls of islands that were made before: most of the islands of mechanical parts have the section of the one beneath.

use std::collections::HashMap;
use std::hash::{Hash, Hasher};
use std::sync::{Arc, Mutex, PoisonError};

use geometry::{Polygon, Region};

use super::path::Path;

/// Walls with this many vertices are kept, and as many again of those used before them.
const KEPT: usize = 100_000;

/// Multiplied with, bits spread over a word: 2⁶⁴ over the golden ratio.
const SPREAD: u64 = 0x9E37_79B9_7F4A_7C15;

/// The walls of an island.
#[derive(Clone, Debug, PartialEq)]
pub struct IslandWalls {
    /// Loops, and beads in narrow places.
    pub paths: Vec<Path>,
    /// What lies inside the innermost: the fill area.
    pub inside: Region,
}

/// What the walls of an island depend on, settings aside.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct WallKey {
    /// Of all vertices, computed once.
    hash: u64,
    island: Polygon,
    height_bits: u64,
    /// Whether it is on the first layer, whose beads may be wider.
    first: bool,
}

impl WallKey {
    pub fn new(island: &Polygon, height_mm: f64, layer: usize) -> Self {
        let vertices = island.rings().flatten();
        let hash = vertices.fold(0, |hash: u64, p| {
            let vertex = u64::from(p.x as u32) << 32 | u64::from(p.y as u32);
            (hash.rotate_left(5) ^ vertex).wrapping_mul(SPREAD)
        });
        Self { hash, island: island.clone(), height_bits: height_mm.to_bits(), first: layer == 0 }
    }
}

impl Hash for WallKey {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.hash.hash(state);
    }
}

/// Walls by what they depend on. What is known never makes a difference to the walls, but to the time that they take.
#[derive(Debug, Default)]
pub(super) struct KnownWalls(Mutex<Generations>);

#[derive(Debug, Default)]
struct Generations {
    recent: HashMap<WallKey, Arc<IslandWalls>>,
    older: HashMap<WallKey, Arc<IslandWalls>>,
    /// Vertices of the recent ones.
    vertices: usize,
}

impl KnownWalls {
    /// The walls of an island, made unless they are known.
    pub fn of(&self, key: WallKey, make: impl FnOnce() -> IslandWalls) -> Arc<IslandWalls> {
        let known = self.generations(|generations| generations.find(&key));
        known.unwrap_or_else(|| {
            let walls = Arc::new(make());
            self.generations(|generations| generations.add(key, Arc::clone(&walls)));
            walls
        })
    }

    fn generations<T>(&self, look: impl FnOnce(&mut Generations) -> T) -> T {
        look(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// Another planner makes walls of its own.
impl Clone for KnownWalls {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl Generations {
    fn find(&mut self, key: &WallKey) -> Option<Arc<IslandWalls>> {
        if let Some(walls) = self.recent.get(key) {
            return Some(Arc::clone(walls));
        }
        let (key, walls) = self.older.remove_entry(key)?;
        self.add(key, Arc::clone(&walls));
        Some(walls)
    }

    fn add(&mut self, key: WallKey, walls: Arc<IslandWalls>) {
        if self.vertices > KEPT {
            self.older = std::mem::take(&mut self.recent);
            self.vertices = 0;
        }
        self.vertices +=
            walls.inside.vertex_count() + walls.paths.iter().map(|path| path.points.len()).sum::<usize>();
        self.recent.insert(key, walls);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::Point;

    fn island(size_mm: f64) -> Polygon {
        let corners = [(0.0, 0.0), (size_mm, 0.0), (size_mm, size_mm), (0.0, size_mm)];
        Polygon { outer: corners.map(|(x, y)| Point::from_mm(x, y)).to_vec(), holes: Vec::new() }
    }

    fn walls(island: &Polygon) -> IslandWalls {
        IslandWalls { paths: Vec::new(), inside: Region::from(island.clone()) }
    }

    #[test]
    fn walls_are_made_once_of_each_section_height_and_kind_of_layer() {
        let known = KnownWalls::default();
        let mut made = Vec::new();
        for (size_mm, height_mm, layer) in
            [(1.0, 0.2, 1), (1.0, 0.2, 2), (2.0, 0.2, 2), (1.0, 0.3, 3), (1.0, 0.2, 0), (2.0, 0.2, 9)]
        {
            let island = island(size_mm);
            let got = known.of(WallKey::new(&island, height_mm, layer), || {
                made.push((size_mm, height_mm, layer));
                walls(&island)
            });
            assert_eq!(*got, walls(&island));
        }
        assert_eq!(made, [(1.0, 0.2, 1), (2.0, 0.2, 2), (1.0, 0.3, 3), (1.0, 0.2, 0)]);
    }

    #[test]
    fn only_so_many_are_kept() {
        let known = KnownWalls::default();
        for i in 0..KEPT {
            let island = island(1.0 + i as f64 * 1e-4);
            known.of(WallKey::new(&island, 0.2, 1), || walls(&island));
        }
        let kept = known.generations(|generations| generations.recent.len() + generations.older.len());
        assert!(kept <= KEPT / 2 + 2, "{kept}");
    }
}
