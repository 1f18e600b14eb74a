//! Marlin 2: the common dialect is its own.

use super::dialect::{Dialect, axes, given, line};
use crate::estimate::MachineSettings;
use crate::gcode::number::text;
use crate::toolpath::ToolId;

pub(in crate::gcode) struct Marlin;

impl Dialect for Marlin {
    /// Accelerations, speeds, and what corners are taken by: builds with junction deviation take J, those with classic
    /// jerk X, Y, Z and E, and each passes over the other's.
    fn limits(&self, out: &mut Vec<u8>, machine: &MachineSettings) {
        axes(out, "M201", machine.max_acceleration.map(|a| a.0));
        axes(out, "M203", machine.max_speed.map(|v| v.0));
        let [print, retract, travel] =
            [machine.print_acceleration, machine.retract_acceleration, machine.travel_acceleration];
        given(out, "M204", &[('P', print), ('R', retract), ('T', travel)]);
        axes(out, "M205", machine.jerk.map(|v| v.0));
        if machine.junction_deviation.0 > 0.0 {
            line(out, &format!("M205 J{}", text(machine.junction_deviation.0, 4)));
        }
        least_speeds(out, machine);
    }

    fn pressure_advance(&self, out: &mut Vec<u8>, _tool: ToolId, seconds: f64) {
        advance(out, seconds);
    }
}

/// The least speeds of printing and of travel.
pub(super) fn least_speeds(out: &mut Vec<u8>, machine: &MachineSettings) {
    let [print, travel] = machine.min_speed.map(|v| text(v.0, 2));
    line(out, &format!("M205 S{print} T{travel}"));
}

pub(super) fn advance(out: &mut Vec<u8>, seconds: f64) {
    line(out, &format!("M900 K{}", text(seconds, 4)));
}
