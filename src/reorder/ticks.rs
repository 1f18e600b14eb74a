//! Decimal numbers as files have them: whole millionths of the file's unit, so that nothing is lost by rounding.

/// Ticks in a unit.
const PER_UNIT: f64 = 1e6;

/// A number of the file as ticks, halves away from zero. What is out of range is clamped.
#[inline]
pub(super) fn ticks(value: f64) -> i64 {
    let ticks = value * PER_UNIT;
    // `f64::round` is a call into the C library on baseline x86-64.
    (ticks + 0.5_f64.copysign(ticks)) as i64
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
    if value < 0 {
        out.push(b'-');
    }
    let (whole, mut rest) = (value.unsigned_abs() / 1_000_000, value.unsigned_abs() % 1_000_000);
    let mut digits = [0; 20];
    let (mut at, mut left) = (digits.len(), whole);
    loop {
        at -= 1;
        digits[at] = b'0' + (left % 10) as u8;
        left /= 10;
        if left == 0 {
            break;
        }
    }
    out.extend_from_slice(&digits[at..]);
    if rest > 0 {
        out.push(b'.');
        let mut power = 100_000;
        while rest > 0 {
            out.push(b'0' + (rest / power) as u8);
            rest %= power;
            power /= 10;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_as_short_as_they_can_be() {
        let text = |value: f64| {
            let mut out = Vec::new();
            push_number(&mut out, ticks(value));
            String::from_utf8(out).unwrap()
        };
        assert_eq!([0.0, -0.05, 12.5, 100.0, 0.000001].map(text), ["0", "-0.05", "12.5", "100", "0.000001"]);
    }
}
