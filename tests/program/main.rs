//! Whole runs, from file to file: through the library, and through the program as users and scripts call it.

#[path = "../support/mod.rs"]
mod support;

mod ahead;
mod binary;
mod bounds;
mod cancel;
mod check;
mod check_model;
mod cli;
mod cli_output;
mod excluded;
#[cfg(unix)]
mod faults;
mod flushes;
mod live;
mod materials;
mod modifiers;
mod package;
mod priming;
mod print;
mod print_assembly;
mod print_floating;
mod print_golden;
mod print_input;
mod print_modes;
mod print_paint;
mod print_plate;
mod print_presets;
mod print_scripts;
mod print_surface;
mod print_volume;
mod printers;
mod programs;
mod project;
mod project_file;
mod reorder;
mod supports;
mod swap;
mod tool_changes;
mod tools;
mod view;
