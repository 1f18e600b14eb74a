//! Cura's machines, qualities and materials, with all extruders of a machine.
//!
//! A machine is a definition (`.def.json`) on top of those it inherits from, its extruder's, its preferred nozzle; or one that a user
//! has added, with the user's nozzle and changes. Print presets are the qualities that its definition has, and what users made of
//! them; filament presets the materials of its diameter. Formulas are worked out.

mod added;
mod config;
mod definition;
mod family;
mod folder;
mod formula;
mod instance;
mod presets;
mod profile;
mod project;
mod said;
mod script;
mod several;
mod stack;
mod table;

pub(super) use folder::{is_file, is_preset};
pub(super) use presets::Cura;
pub(super) use project::{is_project, project};
