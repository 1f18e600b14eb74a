//! Decimal numbers with no more digits than they need, without going through floating-point formatting.

/// Appends `ticks / 10^decimals`: no trailing zeros, no zero before the point (`.05`, as firmwares read it).
pub(super) fn push_fixed(out: &mut Vec<u8>, ticks: i64, decimals: u32) {
    let mut digits = [0_u8; 24];
    let mut at = digits.len();
    let mut rest = ticks.unsigned_abs();
    if rest == 0 {
        out.push(b'0');
        return;
    }
    let mut decimals = decimals;
    while decimals > 0 && rest.is_multiple_of(10) {
        rest /= 10;
        decimals -= 1;
    }
    let mut put = |digit: u8| {
        at -= 1;
        digits[at] = digit;
    };
    if decimals > 0 {
        for _ in 0..decimals {
            put(b'0' + (rest % 10) as u8);
            rest /= 10;
        }
        put(b'.');
    } else {
        put(b'0' + (rest % 10) as u8);
        rest /= 10;
    }
    while rest > 0 {
        put(b'0' + (rest % 10) as u8);
        rest /= 10;
    }
    if ticks < 0 {
        put(b'-');
    }
    out.extend_from_slice(&digits[at..]);
}

/// Appends a space, the letter and the number.
pub(super) fn push_word(out: &mut Vec<u8>, letter: u8, ticks: i64, decimals: u32) {
    out.extend_from_slice(&[b' ', letter]);
    push_fixed(out, ticks, decimals);
}

/// A value to the nearest of `10^decimals` ticks; values that are no numbers become 0, too large ones saturate.
pub(super) fn ticks(value: f64, decimals: u32) -> i64 {
    (value * 10_f64.powi(decimals as i32)).round() as i64
}

/// A value with at most `decimals` digits behind the point, a zero before it: for comments and scripts.
pub(super) fn text(value: f64, decimals: u32) -> String {
    let mut out = Vec::new();
    push_fixed(&mut out, ticks(value, decimals), decimals);
    let text = String::from_utf8_lossy(&out).into_owned();
    match text.strip_prefix('-') {
        Some(positive) if positive.starts_with('.') => format!("-0{positive}"),
        None if text.starts_with('.') => format!("0{text}"),
        _ => text,
    }
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
