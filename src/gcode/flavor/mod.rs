//! What firmwares say differently; all else is common.

mod klipper;
mod marlin;
mod reprapfirmware;

use super::number::push_word;
use crate::profile::Flavor;
use crate::units::{MmPerS2, Ratio};

/// Which moves an acceleration is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Purpose {
    Print,
    Travel,
}

/// A firmware's dialect.
pub(super) trait Dialect {
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

/// The dialect of a flavour.
pub(super) fn dialect(flavor: Flavor) -> &'static dyn Dialect {
    match flavor {
        Flavor::Marlin => &marlin::Marlin,
        Flavor::Klipper => &klipper::Klipper,
        Flavor::RepRapFirmware => &reprapfirmware::RepRapFirmware,
    }
}
