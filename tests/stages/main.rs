//! The stages by their public functions: `cargo test --test stages mesh_repair::` runs the tests of one file.

#[path = "../support/mod.rs"]
mod support;

mod architecture;
mod check_floating;
mod exact;
mod fuzz;
mod gcode_print;
mod gcode_scripts;
mod geom_medial;
mod geom_offset;
mod mesh_load;
mod mesh_place;
mod mesh_repair;
mod order;
mod order_detours;
mod order_layer;
mod ordering_bounds;
mod presets;
mod presets_cura;
mod presets_orca;
mod profile;
mod slice;
mod toolpath;
mod toolpath_bridges;
mod toolpath_raster;
mod toolpath_single;
