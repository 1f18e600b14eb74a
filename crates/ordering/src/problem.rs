//! The ordering problem of one layer, free of anything but ends, loops and precedence.

use super::options::Scope;
use pathwright_geometry::Point;

/// The shape of a path as ordering sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape<'a> {
    /// Drawn from one end to the other, in either direction.
    Open([Point; 2]),
    /// Entered and left at the same vertex: any of these (one, where the seam is pinned).
    Loop(&'a [Point]),
}

impl Shape<'_> {
    /// Where it can be entered.
    pub(crate) fn entries(&self) -> &[Point] {
        match self {
            Self::Open(ends) => ends,
            Self::Loop(vertices) => vertices,
        }
    }
}

/// A path that must be drawn once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Item<'a> {
    /// Index into [`Problem::runs`].
    pub run: u32,
    /// Its ends.
    pub shape: Shape<'a>,
}

/// All paths of one role (and, for walls, one depth) in one island.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Run {
    /// 0: before everything else on the layer, whatever the scope (skirt, brim, support); 1: the rest.
    pub stage: u32,
    /// Island; runs of one island are printed by ascending rank under `feature` and `island`.
    pub island: u32,
    /// Layer, where several are one problem: no run comes before one of a lower layer.
    pub layer: u32,
    /// Position among the runs of its island.
    pub rank: u32,
}

/// One layer: an open walk through every item, at least total link cost.
///
/// Points lie within 10 m of the origin, as those of meshes do: the squares of their distances fit 64 bits.
///
/// Precedence: items of stage 0 come first under every scope. `layer`: nothing else. `feature`: a run is never
/// interrupted, and the runs of one island come by ascending rank; an island may be left between runs.
/// `island`: as `feature`, and all runs of an island (of one stage) are consecutive.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem<'a> {
    /// What must be drawn.
    pub items: Vec<Item<'a>>,
    /// The runs that items refer to; none is empty.
    pub runs: Vec<Run>,
    /// How far items may mix.
    pub scope: Scope,
    /// Where the nozzle is; `None`: anywhere (the first link costs nothing).
    pub start: Option<Point>,
    /// Where the next layer begins; `None`: anywhere (there is no last link).
    pub end: Option<Point>,
}

impl<'a> Problem<'a> {
    /// Shapes without precedence, begun and ended anywhere.
    pub fn of(shapes: impl IntoIterator<Item = Shape<'a>>) -> Self {
        let items = shapes.into_iter().map(|shape| Item { run: 0, shape }).collect();
        let runs = vec![Run { stage: 0, island: 0, layer: 0, rank: 0 }];
        Self { items, runs, scope: Scope::Layer, start: None, end: None }
    }
}

/// One step of a solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Visit {
    /// Index of the item (which is the index of the path in its layer).
    pub item: u32,
    /// Open paths: 0 forwards, 1 backwards. Loops: index into the loop's entry vertices.
    pub entry: u32,
}

/// A solution: every item once.
pub type Sequence = Vec<Visit>;

impl Item<'_> {
    /// Where the nozzle arrives and where it leaves, entered as `entry` says.
    pub fn ends(&self, entry: u32) -> (Point, Point) {
        match self.shape {
            Shape::Open([a, b]) if entry == 0 => (a, b),
            Shape::Open([a, b]) => (b, a),
            Shape::Loop(vertices) => {
                let at = vertices[entry as usize];
                (at, at)
            }
        }
    }
}
