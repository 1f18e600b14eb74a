//! Marlin 1, and firmwares that descend from it or from Sprinter: one acceleration for printing and travel.

use super::dialect::{Dialect, Purpose, axes, given, line};
use super::marlin::{advance, least_speeds};
use crate::estimate::MachineSettings;
use crate::toolpath::ToolId;
use crate::units::MmPerS2;

pub(in crate::gcode) struct MarlinLegacy;

impl Dialect for MarlinLegacy {
    fn has_travel_acceleration(&self) -> bool {
        false
    }

    fn acceleration(&self, out: &mut Vec<u8>, _purpose: Purpose, acceleration: MmPerS2) {
        line(out, &format!("M204 S{}", acceleration.0.round()));
    }

    /// T of M204 is the acceleration of retractions.
    fn limits(&self, out: &mut Vec<u8>, machine: &MachineSettings) {
        axes(out, "M201", machine.max_acceleration.map(|a| a.0));
        axes(out, "M203", machine.max_speed.map(|v| v.0));
        given(out, "M204", &[('S', machine.print_acceleration), ('T', machine.retract_acceleration)]);
        axes(out, "M205", machine.jerk.map(|v| v.0));
        least_speeds(out, machine);
    }

    fn pressure_advance(&self, out: &mut Vec<u8>, _tool: ToolId, seconds: f64) {
        advance(out, seconds);
    }
}
