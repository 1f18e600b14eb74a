//! What dialects have in common.

use crate::estimate::MachineSettings;
use crate::gcode::number::{push_word, text};
use crate::gcode::settings::ObjectLabel;
use crate::motion::RetractSettings;
use crate::toolpath::ToolId;
use crate::units::{MmPerS2, Ratio};

/// Which moves an acceleration is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::gcode) enum Purpose {
    Print,
    Travel,
}

/// A firmware's dialect.
pub(in crate::gcode) trait Dialect {
    /// Whether it keeps one acceleration for printing and another for travel.
    fn has_travel_acceleration(&self) -> bool {
        true
    }

    /// Sets the acceleration of what follows (of that purpose, where it keeps them apart).
    fn acceleration(&self, out: &mut Vec<u8>, purpose: Purpose, acceleration: MmPerS2) {
        out.extend_from_slice(b"M204");
        let letter = if purpose == Purpose::Print { b'P' } else { b'T' };
        push_word(out, letter, acceleration.0.round() as i64, 0);
        out.push(b'\n');
    }

    /// Sets the part-cooling fan.
    fn fan(&self, out: &mut Vec<u8>, share: Ratio) {
        out.extend_from_slice(b"M106");
        push_word(out, b'S', (share.0.clamp(0.0, 1.0) * 255.0).round() as i64, 0);
        out.push(b'\n');
    }

    /// Says what the machine can do, from `[machine]`.
    fn limits(&self, out: &mut Vec<u8>, machine: &MachineSettings);

    /// Sets linear or pressure advance, seconds.
    fn pressure_advance(&self, out: &mut Vec<u8>, tool: ToolId, seconds: f64);

    /// Sets up G10 and G11.
    fn firmware_retraction(&self, out: &mut Vec<u8>, retract: &RetractSettings) {
        let (length, extra) = (text(retract.length.0, 3), text(retract.extra.0.max(0.0), 3));
        line(out, &format!("M207 S{length} F{}", text(retract.speed.0 * 60.0, 0)));
        line(out, &format!("M208 S{extra} F{}", text(retract.unretract_speed.0 * 60.0, 0)));
    }

    /// Says which objects there are. M486 has names only; where they are is said in a comment, for hosts that can cancel objects.
    fn objects(&self, out: &mut Vec<u8>, objects: &[ObjectLabel]) {
        line(out, &format!("M486 T{}", objects.len()));
        for (index, object) in objects.iter().enumerate() {
            self.name_object(out, index, &object.name);
        }
        line(out, "M486 S-1");
        let info = objects.iter().map(|object| {
            let [x, y] = object.center_mm().map(|v| text(v, 2));
            format!("{{\"name\":\"{}\",\"center\":[{x},{y}],\"polygon\":{}}}", object.name, object.polygon())
        });
        line(out, &format!("; objects_info = {{\"objects\":[{}]}}", info.collect::<Vec<_>>().join(",")));
    }

    /// Names an object by M486. Marlin itself has no names and reads capital letters of one as parameters (C would cancel the
    /// object); Prusa's takes a name that stands alone.
    fn name_object(&self, out: &mut Vec<u8>, index: usize, name: &str) {
        line(out, &format!("M486 S{index}\nM486 A{}", name.to_ascii_lowercase()));
    }

    /// What follows belongs to an object, by its number and name.
    fn object_begins(&self, out: &mut Vec<u8>, object: u32, _name: &str) {
        line(out, &format!("M486 S{object}"));
    }

    /// What follows belongs to no object any more.
    fn object_ends(&self, out: &mut Vec<u8>, _name: &str) {
        line(out, "M486 S-1");
    }

    /// The command that pauses for a filament change.
    fn pause(&self) -> &'static str {
        "M600"
    }

    /// Said before the first layer.
    fn print_begins(&self, _out: &mut Vec<u8>, _layers: usize) {}

    /// Said at the start of each layer, counted from 1.
    fn layer_begins(&self, _out: &mut Vec<u8>, _number: usize) {}

    /// Whether the first word of a line can be a macro's name.
    fn has_macros(&self) -> bool {
        false
    }
}

/// Appends a line.
pub(in crate::gcode) fn line(out: &mut Vec<u8>, text: &str) {
    out.extend_from_slice(text.as_bytes());
    out.push(b'\n');
}

/// A command with a word for each of X, Y, Z and E.
pub(super) fn axes(out: &mut Vec<u8>, command: &str, values: [f64; 4]) {
    let words = values.iter().zip("XYZE".chars()).map(|(value, axis)| format!(" {axis}{}", text(*value, 2)));
    line(out, &format!("{command}{}", words.collect::<String>()));
}

/// A command with the words that have a value above 0; nothing where none has.
pub(super) fn given(out: &mut Vec<u8>, command: &str, values: &[(char, MmPerS2)]) {
    let given = values.iter().filter(|(_, value)| value.0 > 0.0);
    let words: String = given.map(|(letter, value)| format!(" {letter}{}", text(value.0, 0))).collect();
    if !words.is_empty() {
        line(out, &format!("{command}{words}"));
    }
}
