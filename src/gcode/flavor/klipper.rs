//! Klipper: one acceleration for everything, extended commands, macros.

use super::{Dialect, Purpose};
use crate::gcode::number::push_fixed;
use crate::units::MmPerS2;

pub(in crate::gcode) struct Klipper;

impl Dialect for Klipper {
    fn has_travel_acceleration(&self) -> bool {
        false
    }

    fn acceleration(&self, out: &mut Vec<u8>, _purpose: Purpose, acceleration: MmPerS2) {
        assign(out, b"SET_VELOCITY_LIMIT ACCEL=", acceleration.0.round() as i64);
    }

    fn pause(&self) -> &'static str {
        "PAUSE"
    }

    fn print_begins(&self, out: &mut Vec<u8>, layers: usize) {
        assign(out, b"SET_PRINT_STATS_INFO TOTAL_LAYER=", layers as i64);
    }

    fn layer_begins(&self, out: &mut Vec<u8>, number: usize) {
        assign(out, b"SET_PRINT_STATS_INFO CURRENT_LAYER=", number as i64);
    }

    fn has_macros(&self) -> bool {
        true
    }
}

fn assign(out: &mut Vec<u8>, command: &[u8], value: i64) {
    out.extend_from_slice(command);
    push_fixed(out, value, 0);
    out.push(b'\n');
}
