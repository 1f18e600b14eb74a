//! The walls of islands that were made before: most of the islands of mechanical parts have the section of the one beneath.

use std::sync::Arc;

use geometry::{Known, KnownAxes, Polygon, Region, Shape};

use super::path::Path;

/// Walls with this many vertices are kept, and as many again of those used before them.
const KEPT: usize = 300_000;

/// The walls of an island.
#[derive(Clone, Debug, PartialEq)]
pub struct IslandWalls {
    /// Loops, and beads in narrow places.
    pub paths: Vec<Path>,
    /// What lies inside the innermost: the fill area.
    pub inside: Region,
    /// Whether another tool's part of the object is beside it.
    pub meets_others: bool,
}

impl IslandWalls {
    fn vertex_count(&self) -> usize {
        self.inside.vertex_count() + self.paths.iter().map(|path| path.points.len()).sum::<usize>()
    }
}

/// What was made before. It never makes a difference to the walls, but to the time that they take.
#[derive(Clone, Debug)]
pub(super) struct KnownWalls {
    walls: Known<IslandWalls>,
    /// Of the narrow places of walls and solid infill.
    pub axes: KnownAxes,
}

impl Default for KnownWalls {
    fn default() -> Self {
        Self { walls: Known::new(KEPT), axes: KnownAxes::default() }
    }
}

impl KnownWalls {
    /// The walls of an island on a layer of some height, made unless they are known.
    pub fn of(
        &self,
        island: &Polygon,
        height_mm: f64,
        layer: usize,
        make: impl FnOnce() -> IslandWalls,
    ) -> Arc<IslandWalls> {
        // Beads of the first layer may be wider.
        let shape = Shape::new([island], [height_mm.to_bits(), u64::from(layer == 0)]);
        self.walls.of(shape, IslandWalls::vertex_count, make)
    }
}
