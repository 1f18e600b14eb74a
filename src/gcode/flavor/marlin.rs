//! Marlin 2: the common dialect is its own.

use super::dialect::{Dialect, axes, line};
use crate::estimate::Machine;
use crate::gcode::number::text;

pub(in crate::gcode) struct Marlin;

impl Dialect for Marlin {
    /// Accelerations, speeds, and what corners are taken by: builds with junction deviation take J, those with classic
    /// jerk X, Y, Z and E, and each passes over the other's.
    fn limits(&self, out: &mut Vec<u8>, machine: &Machine) {
        axes(out, "M201", machine.max_acceleration);
        axes(out, "M203", machine.max_speed);
        axes(out, "M205", machine.jerk);
        line(out, &format!("M205 J{}", text(machine.junction_deviation_mm, 4)));
    }

    fn pressure_advance(&self, out: &mut Vec<u8>, seconds: f64) {
        line(out, &format!("M900 K{}", text(seconds, 4)));
    }
}
