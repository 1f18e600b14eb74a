//! Sections → paths: walls, solid shells, infill, skirt and brim.

mod adhesion;
pub mod bead;
mod beading;
mod beneath;
mod beside_sparse;
mod borders;
mod bridges;
mod combined;
mod entries;
mod fuzzy;
mod held_ends;
mod hollow;
pub mod infill;
mod island_walls;
mod known_walls;
mod laid;
mod layer_builder;
mod leftovers;
mod options;
mod overhang_perimeters;
mod path;
mod planner;
mod reach;
pub mod seams;
mod shell_depth;
mod shell_windows;
mod shells;
mod single;
mod spiral;
mod stems;
pub mod support;
mod tools;
mod unfold;
mod walls;

pub use adhesion::{raft, raft_area};
pub use beading::Gap;
pub use island_walls::LayerWalls;
pub use known_walls::IslandWalls;
pub use options::{
    BridgeSettings, BrimSettings, BrimSides, FirstLayerSettings, FuzzySettings, FuzzyWalls, InfillSettings,
    IroningSettings, Pattern, PrimeTowerSettings, RaftSettings, ShellSettings, SingleOnTop, SkirtSettings,
    SpiralSettings, SupportPattern, SupportSettings, SupportStyle, ToolOfSettings, WallGenerator, WallOrder,
    WallSettings,
};
pub use path::{Entries, Island, IslandId, LayerKind, LayerPaths, Path, Phase, Role, ToolId, Turn, Width};
pub use planner::{ObjectLayer, Planner, PlateLayer, Share, ToolpathSettings};
pub use shell_depth::{bottom_layers, shell_depth};
pub use shell_windows::{Map, ShellWindows, Shells, Window};
pub use shells::Zones;
pub use spiral::{Revolution, Rise, SpiralSpec, align, level, outline, revolution};
pub use tools::{ToolHeights, tool_heights};
pub use walls::{WallSpec, Walls};
