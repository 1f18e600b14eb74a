//! What the toolpath stage makes: paths that know their role, width, height and island.

use std::collections::BTreeMap;

use super::spiral::Rise;
use crate::units::Seconds;
use geometry::{Point, Region};

/// What a path is for. The order of the variants is the order in which an island is printed by default.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[allow(missing_docs)]
pub enum Role {
    Skirt,
    Brim,
    Support,
    SupportInterface,
    Perimeter,
    ExternalPerimeter,
    OverhangPerimeter,
    GapFill,
    SolidInfill,
    BridgeInfill,
    InternalInfill,
    TopSolidInfill,
    Ironing,
    PrimeTower,
}

impl Role {
    /// Every role, in order.
    pub const ALL: [Role; 14] = [
        Role::Skirt,
        Role::Brim,
        Role::Support,
        Role::SupportInterface,
        Role::Perimeter,
        Role::ExternalPerimeter,
        Role::OverhangPerimeter,
        Role::GapFill,
        Role::SolidInfill,
        Role::BridgeInfill,
        Role::InternalInfill,
        Role::TopSolidInfill,
        Role::Ironing,
        Role::PrimeTower,
    ];

    /// Whether it is a wall.
    pub fn is_wall(self) -> bool {
        self == Role::Perimeter || self.is_outer_wall()
    }

    /// Whether it is the outermost wall, or one that hangs over, which is treated alike.
    pub fn is_outer_wall(self) -> bool {
        matches!(self, Role::ExternalPerimeter | Role::OverhangPerimeter)
    }

    /// The name in `;TYPE:` comments, as viewers know it.
    pub fn type_name(self) -> &'static str {
        match self {
            Role::Skirt | Role::Brim => "Skirt/Brim",
            Role::Support => "Support material",
            Role::SupportInterface => "Support material interface",
            Role::Perimeter => "Perimeter",
            Role::ExternalPerimeter => "External perimeter",
            Role::OverhangPerimeter => "Overhang perimeter",
            Role::GapFill => "Gap fill",
            Role::SolidInfill => "Solid infill",
            Role::BridgeInfill => "Bridge infill",
            Role::InternalInfill => "Internal infill",
            Role::TopSolidInfill => "Top solid infill",
            Role::Ironing => "Ironing",
            Role::PrimeTower => "Wipe tower",
        }
    }
}

/// Bead width along a path, in millimetres (width of the flattened bead, not its spacing).
#[derive(Clone, Debug, PartialEq)]
pub enum Width {
    /// The same everywhere.
    Constant(f64),
    /// One for each vertex of the path, linear in between.
    PerVertex(Vec<f32>),
}

impl Width {
    /// At a vertex.
    pub(crate) fn at_mm(&self, vertex: usize) -> f64 {
        match self {
            Self::Constant(width_mm) => *width_mm,
            Self::PerVertex(widths) => widths[vertex].into(),
        }
    }

    /// The widest place.
    pub(crate) fn widest_mm(&self) -> f64 {
        match self {
            Self::Constant(width_mm) => *width_mm,
            Self::PerVertex(widths) => widths.iter().copied().fold(0.0, f32::max).into(),
        }
    }

    /// The mean of all vertices.
    pub(crate) fn mean_mm(&self) -> f64 {
        match self {
            Self::Constant(width_mm) => *width_mm,
            Self::PerVertex(widths) => {
                widths.iter().map(|w| f64::from(*w)).sum::<f64>() / widths.len().max(1) as f64
            }
        }
    }
}

/// One uninterrupted bead.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// What it is for.
    pub role: Role,
    /// Whether it returns from the last vertex to the first (which is not repeated).
    pub closed: bool,
    /// Vertices, at least two (closed: at least three), no two neighbours equal.
    pub points: Vec<Point>,
    /// Bead width.
    pub width: Width,
    /// Bead height in millimetres.
    pub height_mm: f64,
    /// The island it belongs to; `None`: skirt, brim and support, which belong to none.
    pub island: Option<IslandId>,
    /// When it is printed, among the paths of its island.
    pub phase: Phase,
    /// Which tool prints it; `None`: any.
    pub tool: Option<ToolId>,
}

/// A tool, counted from 0.
pub type ToolId = u8;

/// Index into [`LayerPaths::islands`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct IslandId(pub u32);

impl IslandId {
    /// As an index.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// When a path is printed, among those of its island or, of skirt, brim and support, among those of none.
///
/// Ordering under `feature` and `island` scope prints phases in this order and never mixes them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Phase {
    /// The prime tower, and what else a tool is flushed into.
    Tower(u32),
    /// Around everything.
    Skirt,
    /// Around the part.
    Brim,
    /// Support, and rafts.
    Support,
    /// Dense support under the part.
    SupportInterface,
    /// Walls of one depth, 0 those printed first.
    Wall(u32),
    /// Gaps between walls, solid and sparse infill, bridges.
    Inside,
    /// Top surfaces; of a monotonic one the lines one after the other.
    Top(u32),
    /// A second pass over top surfaces.
    Ironing,
    /// Of a finished file: as it was found there.
    Found(u32),
}

/// A connected part of a layer's section.
#[derive(Clone, Debug, PartialEq)]
pub struct Island {
    /// Which object on the plate it belongs to.
    pub object: u32,
    /// Whether the same outline is beneath it, so that its walls hang over nothing.
    pub repeats: bool,
    /// Whether another tool's part of the object is beside it. Its beads are fitted to that one's, and drawn as they are planned.
    pub meets_others: bool,
}

/// All paths of one layer, in the order in which they were made.
#[derive(Clone, Debug, PartialEq)]
pub struct LayerPaths {
    /// Index from the bed, 0 the first layer.
    pub index: usize,
    /// Top of the layer over the bed, without Z offset, millimetres.
    pub top_mm: f64,
    /// Height of the layer, millimetres.
    pub height_mm: f64,
    /// Connected parts of the section.
    pub islands: Vec<Island>,
    /// The paths.
    pub paths: Vec<Path>,
    /// The section they were made from.
    pub outline: Region,
    /// What they rest on, the section one layer down; `None`: the bed.
    pub beneath: Option<Region>,
    /// Whether it is level.
    pub kind: LayerKind,
    /// Closed paths that may be entered at some of their vertices only, by their index.
    pub entries: BTreeMap<u32, Entries>,
    /// The tools that print it, in their order; empty: the printer has one.
    pub tools: Vec<ToolId>,
    /// What tools lay into the prime tower before another is taken, by their tool.
    pub rams: Vec<Path>,
    /// Which part of a layer that is printed in several turns it is.
    pub turn: Turn,
}

/// A layer's part that is printed by itself.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Turn {
    /// Whether something of the layer has been printed before.
    pub is_later: bool,
    /// Top of what stands beside it already, without Z offset, over which the nozzle passes from island to island, millimetres;
    /// 0: nothing is higher.
    pub beside_mm: f64,
    /// What other tools take at least for as much, before the next part of this tool or after the last one.
    pub elsewhere: Seconds,
    /// Whether its tools are primed in it, before all layers; the first of them is loaded then.
    pub primes: bool,
}

impl LayerPaths {
    /// Inserts paths before the one with this index.
    pub fn insert(&mut self, index: usize, paths: impl IntoIterator<Item = Path>) {
        let before = self.paths.len();
        self.paths.splice(index..index, paths);
        let more = (self.paths.len() - before) as u32;
        let moved = |(path, entries)| (if path as usize >= index { path + more } else { path }, entries);
        self.entries = std::mem::take(&mut self.entries).into_iter().map(moved).collect();
    }
}

impl LayerPaths {
    /// Takes away the paths that are not to stay.
    pub fn retain(&mut self, stays: impl Fn(&Path) -> bool) {
        let entries = std::mem::take(&mut self.entries);
        let mut kept = 0;
        for (index, path) in std::mem::take(&mut self.paths).into_iter().enumerate() {
            if stays(&path) {
                let own = entries.get(&(index as u32)).cloned();
                self.entries.extend(own.map(|own| (kept, own)));
                self.paths.push(path);
                kept += 1;
            }
        }
    }
}

/// The vertices of a loop at which it may be entered.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Entries {
    /// Indices of the vertices, ascending.
    pub vertices: Vec<u32>,
    /// Where they are.
    pub points: Vec<Point>,
}

/// Whether a layer is level.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum LayerKind {
    /// It is.
    #[default]
    Flat,
    /// It is one revolution of a spiral, which is its only path and rises so, vertex by vertex.
    Spiral(Vec<Rise>),
}
