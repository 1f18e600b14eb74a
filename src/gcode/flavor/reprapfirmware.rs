//! RepRapFirmware 3: fan values are shares. A pause by M600 runs `filament-change.g`, or `pause.g`.

use super::Dialect;
use crate::gcode::number::{push_word, ticks};
use crate::units::Ratio;

pub(in crate::gcode) struct RepRapFirmware;

impl Dialect for RepRapFirmware {
    fn fan(&self, out: &mut Vec<u8>, share: Ratio) {
        out.extend_from_slice(b"M106");
        push_word(out, b'S', ticks(share.0.clamp(0.0, 1.0), 2), 2);
        out.push(b'\n');
    }
}
