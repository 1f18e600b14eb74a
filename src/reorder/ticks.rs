//! Decimal numbers as files have them: whole millionths of the file's unit, so that nothing is lost by rounding.

use crate::gcode;

/// Decimals that ticks have.
const DECIMALS: u32 = 6;

/// Ticks in a unit.
const PER_UNIT: f64 = 1e6;

/// A number of the file as ticks, halves away from zero. What is out of range is clamped.
#[inline]
pub(super) fn ticks(value: f64) -> i64 {
    gcode::nearest(value * PER_UNIT)
}

/// Ticks as a number.
pub(super) fn units(ticks: i64) -> f64 {
    ticks as f64 / PER_UNIT
}

/// Whether a number of the file is given in no more decimals than ticks have, but for errors of computing.
pub(super) fn is_whole(value: f64) -> bool {
    (ticks(value) as f64 - value * PER_UNIT).abs() < 1e-2
}

/// Millimetres in units of the file.
#[inline]
pub(super) fn in_units(mm: f64, scale: f64) -> f64 {
    // Nearly all files are in millimetres, and dividing takes long.
    if scale == 1.0 { mm } else { mm / scale }
}

/// Appends a letter and a number, without zeros at its end: ` X12.5`.
pub(super) fn push_word(out: &mut Vec<u8>, letter: u8, value: i64) {
    out.extend_from_slice(&[b' ', letter]);
    push_number(out, value);
}

/// Appends a number without zeros at its end.
pub(super) fn push_number(out: &mut Vec<u8>, value: i64) {
    gcode::push_number(out, value, DECIMALS);
}
