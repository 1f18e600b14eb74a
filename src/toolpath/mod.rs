//! Sections → paths: walls, solid shells, infill, skirt and brim.

mod adhesion;
pub mod bead;
mod beading;
mod bridges;
mod entries;
mod footing;
mod fuzzy;
pub mod infill;
mod layer_builder;
mod options;
mod path;
mod planner;
mod reach;
mod shells;
mod spiral;
mod stacks;
pub mod support;
mod walls;

pub use adhesion::{raft, raft_area};
pub use beading::Gap;
pub use options::{
    BridgeSettings, BrimSettings, BrimSides, FirstLayerSettings, FuzzySettings, FuzzyWalls, InfillSettings,
    IroningSettings, Pattern, RaftSettings, ShellSettings, SkirtSettings, SpiralSettings, SupportPattern,
    SupportSettings, SupportStyle, WallGenerator, WallOrder, WallSettings,
};
pub use path::{Island, IslandId, LayerKind, LayerPaths, Path, Phase, Role, Width};
pub use planner::{ObjectLayer, Planner, PlateLayer, ToolpathSettings};
pub use shells::{Map, ShellWindows, Shells, Zones, bottom_layers, shell_depth};
pub use spiral::{Rise, SpiralSpec, Turn, align, level, outline, turn};
pub use walls::{WallSpec, Walls};
