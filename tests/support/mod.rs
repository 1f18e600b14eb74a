//! What tests of several programs use. Each of them names this folder in one line of its `main.rs`.

#![allow(dead_code, reason = "each test program uses a part of it")]

pub mod cases;
pub mod found;
pub mod gcode_fixture;
pub mod mesh_shapes;
pub mod oracle;
pub mod print;
pub mod program;
pub mod saved_project;
pub mod strokes;
pub mod toolpath_plan;
