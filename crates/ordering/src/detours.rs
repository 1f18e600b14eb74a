//! The true cost of travels inside islands: the route around holes and outer walls, or over them and retracted where
//! it is too long.

use std::cell::RefCell;

use rustc_hash::FxHashMap;

use super::{Cost, LinkKind};
use pathwright_geometry::real;
use pathwright_geometry::{Route, Router};

/// How travels are led around what they must not cross.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DetourRule {
    /// Width of the outermost wall, millimetres.
    pub wall_width_mm: f64,
    /// By how much a detour may lengthen a travel, millimetres.
    pub max_mm: f64,
    /// Cost of a retraction in millimetres: travels inside are not retracted up to this length.
    pub retraction_mm: f64,
}

impl DetourRule {
    /// Cost of the travel between two positions in an island. A detour costs what a travel of that length does; crossing a wall, what
    /// the travel costs with a retraction, and where lengths count, that much more as is travelled without one.
    pub fn cost(self, router: &Router, cost: &Cost, [from, to]: [[f64; 2]; 2], climbs: bool) -> f64 {
        match (router.route(from, to), cost) {
            (Route::Inside(_, length_mm), _) => cost.of(length_mm, LinkKind { inside: true, climbs }),
            (Route::Across, Cost::Length) => {
                real::hypot(from[0] - to[0], from[1] - to[1]) + self.retraction_mm
            }
            (Route::Across, Cost::Time(_)) => {
                cost.of(real::hypot(from[0] - to[0], from[1] - to[1]), LinkKind { inside: false, climbs })
            }
        }
    }
}

/// The detours of consecutive layers, ordered as one problem. Remembers what it was asked.
#[derive(Debug)]
pub struct Detours<'a> {
    rule: DetourRule,
    cost: Cost,
    routers: &'a [Router<'a>],
    /// The first item of each layer, ascending.
    first_item: Vec<u32>,
    known: RefCell<FxHashMap<(u32, [u64; 4]), f64>>,
}

impl<'a> Detours<'a> {
    /// Those of layers with this many items each, which are numbered through, each layer with its router.
    pub fn new(
        rule: DetourRule,
        cost: Cost,
        items: impl IntoIterator<Item = usize>,
        routers: &'a [Router<'a>],
    ) -> Self {
        let mut count = 0;
        let first_item = items.into_iter().map(|items| {
            let first = count;
            count += items as u32;
            first
        });
        Self { rule, cost, first_item: first_item.collect(), routers, known: RefCell::default() }
    }

    /// Cost of the travel between positions on two items of an island, of one layer or of neighbouring ones; the same in both
    /// directions.
    pub fn cost(&self, items: [u32; 2], from: [f64; 2], to: [f64; 2]) -> f64 {
        let (from, to) = if from <= to { (from, to) } else { (to, from) };
        // The nozzle climbs first, so the upper layer's outline matters.
        let of = |item: u32| self.first_item.partition_point(|&first| first <= item) - 1;
        let layer = of(items[0].max(items[1]));
        let climbs = items[0].min(items[1]) < self.first_item[layer];
        let key = (2 * layer as u32 + u32::from(climbs), [from[0], from[1], to[0], to[1]].map(f64::to_bits));
        let find = || self.rule.cost(&self.routers[layer], &self.cost, [from, to], climbs);
        *self.known.borrow_mut().entry(key).or_insert_with(find)
    }
}
