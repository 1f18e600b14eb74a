//! Decimal numbers with no more digits than they need, without going through floating-point formatting.

/// `00` to `99`.
const PAIRS: [[u8; 2]; 100] = {
    let mut pairs = [[0; 2]; 100];
    let mut i = 0;
    while i < 100 {
        pairs[i] = [b'0' + (i / 10) as u8, b'0' + (i % 10) as u8];
        i += 1;
    }
    pairs
};

/// Appends `ticks / 10^decimals`: no trailing zeros, no zero before the point (`.05`, as firmwares read it).
pub(super) fn push_fixed(out: &mut Vec<u8>, ticks: i64, decimals: u32) {
    push(out, ticks, decimals, false);
}

/// Appends `ticks / 10^decimals`: no trailing zeros, a zero before the point (`0.05`).
pub(crate) fn push_number(out: &mut Vec<u8>, ticks: i64, decimals: u32) {
    push(out, ticks, decimals, true);
}

#[inline]
fn push(out: &mut Vec<u8>, ticks: i64, decimals: u32, leading_zero: bool) {
    if ticks == 0 {
        out.push(b'0');
        return;
    }
    let mut digits = [b'0'; 24];
    let mut at = digits.len();
    // Two digits at a time, in 32 bits as soon as they do: most numbers are that short.
    let mut long = ticks.unsigned_abs();
    while long > u64::from(u32::MAX) {
        at -= 2;
        digits[at..at + 2].copy_from_slice(&PAIRS[(long % 100) as usize]);
        long /= 100;
    }
    let mut rest = long as u32;
    while rest >= 10 {
        at -= 2;
        digits[at..at + 2].copy_from_slice(&PAIRS[(rest % 100) as usize]);
        rest /= 100;
    }
    if rest > 0 {
        at -= 1;
        digits[at] = b'0' + rest as u8;
    }
    let point = digits.len() - decimals as usize;
    let mut end = digits.len();
    while end > point && digits[end - 1] == b'0' {
        end -= 1;
    }
    // Pairs may begin with a zero.
    while at < point && digits[at] == b'0' {
        at += 1;
    }
    if ticks < 0 {
        out.push(b'-');
    }
    if at < point {
        out.extend_from_slice(&digits[at..point]);
    } else if leading_zero {
        out.push(b'0');
    }
    if end > point {
        out.push(b'.');
        out.extend_from_slice(&digits[point..end]);
    }
}

/// Appends a space, the letter and the number.
pub(super) fn push_word(out: &mut Vec<u8>, letter: u8, ticks: i64, decimals: u32) {
    out.extend_from_slice(&[b' ', letter]);
    push_fixed(out, ticks, decimals);
}

/// The nearest whole number, halves away from zero; NaN becomes 0, too large ones
/// saturate. (`f64::round` is a call into the C library on the x86-64 that we build for.)
#[inline]
pub(crate) fn nearest(value: f64) -> i64 {
    (value + 0.5_f64.copysign(value)) as i64
}

/// A value to the nearest of `10^decimals` ticks.
#[inline]
pub(super) fn ticks(value: f64, decimals: u32) -> i64 {
    const POWERS: [f64; 8] = [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7];
    nearest(value * POWERS[decimals as usize & 7])
}

/// A value with at most `decimals` digits behind the point, a zero before it: for comments and scripts.
pub(super) fn text(value: f64, decimals: u32) -> String {
    let mut out = Vec::new();
    push_number(&mut out, ticks(value, decimals), decimals);
    String::from_utf8_lossy(&out).into_owned()
}

/// Free text as it may stand in a command or comment: no line ends or other control characters, and no
/// semicolon, which would begin a comment.
pub(crate) fn one_line(text: &str) -> String {
    text.chars()
        .map(|c| match c {
            ';' => ',',
            c if c.is_control() => ' ',
            c => c,
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn fixed(ticks: i64, decimals: u32) -> String {
        let mut out = Vec::new();
        push_fixed(&mut out, ticks, decimals);
        String::from_utf8(out).expect("digits")
    }

    #[test]
    fn numbers_have_no_more_digits_than_they_need() {
        let cases =
            [(0, "0"), (5, ".005"), (-50, "-.05"), (1000, "1"), (123_450, "123.45"), (-10_000, "-10")];
        for (ticks, wanted) in cases {
            assert_eq!(fixed(ticks, 3), wanted);
        }
        assert_eq!(fixed(1200, 0), "1200");
        assert_eq!(fixed(i64::MIN, 5), "-92233720368547.75808");
        let short = [0, -50_000, 12_500_000, 100_000_000, 1].map(|ticks| {
            let mut out = Vec::new();
            push_number(&mut out, ticks, 6);
            String::from_utf8(out).expect("digits")
        });
        assert_eq!(short, ["0", "-0.05", "12.5", "100", "0.000001"]);
        assert_eq!(
            (text(0.2, 3), text(-0.25, 3), text(f64::NAN, 3)),
            ("0.2".into(), "-0.25".into(), "0".into())
        );
    }

    proptest! {
        #[test]
        fn they_read_back_as_what_was_written(ticks in -10_000_000_000..10_000_000_000_i64, decimals in 0..6_u32) {
            let value: f64 = fixed(ticks, decimals).parse().expect("a number");
            prop_assert_eq!((value * 10_f64.powi(decimals as i32)).round() as i64, ticks);
        }
    }
}
