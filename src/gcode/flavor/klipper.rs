//! Klipper: one acceleration for everything, extended commands, macros.

use super::dialect::{Dialect, Purpose, line};
use crate::estimate::MachineSettings;
use crate::gcode::number::{push_fixed, text};
use crate::gcode::settings::ObjectLabel;
use crate::motion::RetractSettings;
use crate::toolpath::ToolId;
use crate::units::MmPerS2;

pub(in crate::gcode) struct Klipper;

impl Dialect for Klipper {
    fn has_travel_acceleration(&self) -> bool {
        false
    }

    fn acceleration(&self, out: &mut Vec<u8>, _purpose: Purpose, acceleration: MmPerS2) {
        assign(out, b"SET_VELOCITY_LIMIT ACCEL=", acceleration.0.round() as i64);
    }

    fn limits(&self, out: &mut Vec<u8>, machine: &MachineSettings) {
        let limits = [
            ("VELOCITY", machine.max_speed[0].0),
            ("ACCEL", machine.max_acceleration[0].0),
            ("SQUARE_CORNER_VELOCITY", machine.square_corner_velocity.0),
            ("MINIMUM_CRUISE_RATIO", machine.min_cruise_ratio.0),
        ];
        command(out, "SET_VELOCITY_LIMIT", &limits);
    }

    fn pressure_advance(&self, out: &mut Vec<u8>, _tool: ToolId, seconds: f64) {
        command(out, "SET_PRESSURE_ADVANCE", &[("ADVANCE", seconds)]);
    }

    fn firmware_retraction(&self, out: &mut Vec<u8>, retract: &RetractSettings) {
        let values = [
            ("RETRACT_LENGTH", retract.length.0),
            ("RETRACT_SPEED", retract.speed.0),
            ("UNRETRACT_EXTRA_LENGTH", retract.extra.0.max(0.0)),
            ("UNRETRACT_SPEED", retract.unretract_speed.0),
        ];
        command(out, "SET_RETRACTION", &values);
    }

    fn objects(&self, out: &mut Vec<u8>, objects: &[ObjectLabel]) {
        for object in objects {
            let [x, y] = object.center_mm().map(|v| text(v, 2));
            let (name, polygon) = (&object.name, object.polygon());
            line(out, &format!("EXCLUDE_OBJECT_DEFINE NAME={name} CENTER={x},{y} POLYGON={polygon}"));
        }
    }

    fn object_begins(&self, out: &mut Vec<u8>, _object: u32, name: &str) {
        line(out, &format!("EXCLUDE_OBJECT_START NAME={name}"));
    }

    fn object_ends(&self, out: &mut Vec<u8>, name: &str) {
        line(out, &format!("EXCLUDE_OBJECT_END NAME={name}"));
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

/// An extended command.
fn command(out: &mut Vec<u8>, name: &str, values: &[(&str, f64)]) {
    let words = values.iter().map(|(key, value)| format!(" {key}={}", text(*value, 4)));
    line(out, &format!("{name}{}", words.collect::<String>()));
}

fn assign(out: &mut Vec<u8>, command: &[u8], value: i64) {
    out.extend_from_slice(command);
    push_fixed(out, value, 0);
    out.push(b'\n');
}
