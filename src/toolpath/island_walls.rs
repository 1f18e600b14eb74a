//! The walls of islands with the single beads between them: what is planned first, as it depends on the fewest settings.

use super::beneath::Beneath;
use super::fuzzy::Fuzzy;
use super::known_walls::{IslandWalls, KnownWalls};
use super::layer_builder::LayerBuilder;
use super::options::{FuzzySettings, WallOrder, WallSettings};
use super::single::{self, Count};
use super::stems;
use super::walls::{self, WallSpec, Walls};
use super::{IslandId, Path, Phase, Role};
use crate::units::Mm;
use geometry::{Polygon, Region};

/// Islands without a loop, of which lines fill less than this share, are too small for lines.
const SMALL: f64 = 0.5;

/// The walls of a layer, island by island.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LayerWalls {
    /// In the order in which the layer has them.
    pub islands: Vec<IslandWalls>,
}

/// Makes walls, from the only settings that they depend on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct WallPlanner<'s> {
    pub walls: &'s WallSettings,
    pub fuzzy: &'s FuzzySettings,
    /// Width of all beads of the first layer; 0: as on the others.
    pub first_width: Mm,
}

/// A layer of one object, as far as walls depend on it.
pub(super) struct WallLayer<'a> {
    pub index: usize,
    pub height_mm: f64,
    pub object: u32,
    pub section: &'a Region,
    /// One layer up; empty on its last layer.
    pub above: &'a Region,
    /// One layer down; `None`: the bed.
    pub beneath: Option<&'a Region>,
}

impl WallPlanner<'_> {
    /// The width of a bead on a layer.
    pub fn on(&self, layer: usize, width: Mm) -> f64 {
        match self.first_width.0 {
            first_mm if layer == 0 && first_mm > 0.0 => first_mm,
            _ => width.0,
        }
    }

    /// Widths and limits of the walls of a layer.
    pub fn spec(&self, layer: usize, height_mm: f64) -> WallSpec {
        WallSpec {
            count: self.walls.count,
            external_width_mm: self.on(layer, self.walls.external_width),
            width_mm: self.on(layer, self.walls.width),
            height_mm,
            gap_fill: self.walls.gap_fill,
            min_feature_mm: self.walls.min_feature.0,
            generator: self.walls.generator,
            precise: self.walls.precise,
        }
    }

    /// The walls of an island as lines.
    pub fn trace(&self, island: &Polygon, spec: &WallSpec, layer: &WallLayer<'_>) -> Walls {
        match Count::of(self.walls, layer.above, layer.index) {
            Count::All => walls::trace(island, spec),
            Count::One => walls::trace(island, &WallSpec { count: 1, ..*spec }),
            Count::OneWhereBare => {
                let under_mm = spec.width_mm / 2.0;
                let least_mm = self.walls.min_top_width.0;
                walls::trace_single(island, spec, |inside| {
                    single::bare(inside, layer.above, layer.beneath, least_mm, under_mm)
                })
            }
        }
    }

    /// The walls of each island of an object; the first one has this number.
    pub fn object(&self, layer: &WallLayer<'_>, first: usize, known: &KnownWalls) -> Vec<IslandWalls> {
        let fuzzy = self.fuzzy(layer);
        let support_below = layer.beneath.map(Beneath::new);
        let alike = self.are_alike(layer, fuzzy.as_ref());
        let islands = layer.section.polygons().iter().zip(first..);
        let island = |(polygon, number)| {
            let make = || self.island(polygon, layer, fuzzy.as_ref(), known);
            let mut walls = if alike {
                known.of(polygon, layer.height_mm, layer.index, make).as_ref().clone()
            } else {
                make()
            };
            if let Some(support_below) = &support_below {
                self.hold(&mut walls.paths, polygon, support_below);
            }
            for path in &mut walls.paths {
                path.island = Some(IslandId(number as u32));
            }
            walls
        };
        islands.map(island).collect()
    }

    /// What lies inside the walls of an island.
    pub fn inside(&self, polygon: &Polygon, layer: &WallLayer<'_>, known: &KnownWalls) -> Region {
        if !self.are_alike(layer, self.fuzzy(layer).as_ref()) {
            return self.trace(polygon, &self.spec(layer.index, layer.height_mm), layer).inside;
        }
        let make = || self.island(polygon, layer, None, known);
        known.of(polygon, layer.height_mm, layer.index, make).inside.clone()
    }

    fn fuzzy<'a>(&'a self, layer: &WallLayer<'a>) -> Option<Fuzzy<'a>> {
        Fuzzy::new(self.fuzzy, layer.beneath, layer.index, layer.object)
    }

    /// Whether islands with the same outline have the same walls: others depend on more than that.
    fn are_alike(&self, layer: &WallLayer<'_>, fuzzy: Option<&Fuzzy<'_>>) -> bool {
        fuzzy.is_none() && Count::of(self.walls, layer.above, layer.index) == Count::All
    }

    /// The walls of an island, whatever is beneath.
    fn island(
        &self,
        polygon: &Polygon,
        on: &WallLayer<'_>,
        fuzzy: Option<&Fuzzy<'_>>,
        known: &KnownWalls,
    ) -> IslandWalls {
        let spec = &self.spec(on.index, on.height_mm);
        let mut layer = LayerBuilder::new(on.height_mm, &known.axes);
        let Walls { loops, gaps, inside } = self.trace(polygon, spec, on);
        let count = self.walls.count;
        let wall = |depth: u32| match self.walls.order {
            WallOrder::InnerFirst => Phase::Wall(count - 1 - depth),
            WallOrder::OuterFirst => Phase::Wall(depth),
        };
        let mut by_depth: Vec<_> = loops.into_iter().enumerate().collect();
        if self.walls.order == WallOrder::InnerFirst {
            by_depth.reverse();
        }
        for (depth, lines) in by_depth {
            let (role, width_mm) = match depth {
                0 => (Role::ExternalPerimeter, spec.external_width_mm),
                _ => (Role::Perimeter, spec.width_mm),
            };
            let lines = match fuzzy {
                Some(fuzzy) => fuzzy.roughen(lines, depth),
                None => lines,
            };
            layer.lines(role, wall(depth as u32), width_mm, lines);
        }
        let is_thin = layer.paths.is_empty();
        let mut filled_mm2 = 0.0;
        for (depth, gap) in &gaps {
            let (role, phase) = match depth {
                0 if count > 0 => (Role::ExternalPerimeter, wall(0)),
                _ => (Role::GapFill, Phase::Inside),
            };
            let least_mm = if *depth == 0 { self.walls.min_width.0 } else { 0.0 };
            filled_mm2 +=
                layer.gap(role, phase, gap, spec.least_gap_mm(*depth)..=spec.widest_gap_mm(), least_mm);
        }
        let is_small = !gaps.is_empty() && inside.is_empty() && is_thin;
        if is_small && filled_mm2 < SMALL * polygon.area_mm2() {
            let phase = if count > 0 { wall(0) } else { Phase::Inside };
            layer.dot(phase, 0, filled_mm2, polygon, self.walls);
        }
        IslandWalls { paths: layer.paths, inside, meets_others: false }
    }

    /// Changes the walls of an island so that the layer beneath holds them.
    fn hold(&self, paths: &mut Vec<Path>, polygon: &Polygon, support_below: &Beneath<'_>) {
        let loose = support_below.reach(paths, polygon);
        let waits = self.walls.order == WallOrder::InnerFirst && support_below.outer_first(paths);
        stems::join(paths, &loose, support_below);
        if waits {
            for path in paths {
                if let Phase::Wall(place) = &mut path.phase {
                    *place = self.walls.count - 1 - *place;
                }
            }
        }
    }
}
