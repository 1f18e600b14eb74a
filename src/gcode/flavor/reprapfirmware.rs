//! RepRapFirmware 3: fan values are shares. A pause by M600 runs `filament-change.g`, or `pause.g`.

use super::dialect::{Dialect, axes, given, line};
use crate::estimate::MachineSettings;
use crate::gcode::number::{push_word, text, ticks};
use crate::motion::RetractSettings;
use crate::toolpath::ToolId;
use crate::units::Ratio;

pub(in crate::gcode) struct RepRapFirmware;

impl Dialect for RepRapFirmware {
    fn fan(&self, out: &mut Vec<u8>, share: Ratio) {
        out.extend_from_slice(b"M106");
        push_word(out, b'S', ticks(share.0.clamp(0.0, 1.0), 2), 2);
        out.push(b'\n');
    }

    /// Its speeds are a minute's.
    fn limits(&self, out: &mut Vec<u8>, machine: &MachineSettings) {
        axes(out, "M201", machine.max_acceleration.map(|a| a.0));
        axes(out, "M203", machine.max_speed.map(|v| v.0 * 60.0));
        given(out, "M204", &[('P', machine.print_acceleration), ('T', machine.travel_acceleration)]);
        axes(out, "M566", machine.jerk.map(|v| v.0 * 60.0));
    }

    fn pressure_advance(&self, out: &mut Vec<u8>, tool: ToolId, seconds: f64) {
        line(out, &format!("M572 D{tool} S{}", text(seconds, 4)));
    }

    fn firmware_retraction(&self, out: &mut Vec<u8>, retract: &RetractSettings) {
        let (length, extra) = (text(retract.length.0, 3), text(retract.extra.0.max(0.0), 3));
        let [back, forward] = [retract.speed, retract.unretract_speed].map(|v| text(v.0 * 60.0, 0));
        line(out, &format!("M207 S{length} R{extra} F{back} T{forward}"));
    }

    fn name_object(&self, out: &mut Vec<u8>, index: usize, name: &str) {
        line(out, &format!("M486 S{index} A\"{name}\""));
    }
}
