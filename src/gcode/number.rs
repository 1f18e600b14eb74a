//! Decimal numbers with no more digits than they need, without going through floating-point formatting.

/// `000` to `999`, and how many zeros each ends in.
static TRIPLES: [[u8; 4]; 1000] = {
    let mut triples = [[0; 4]; 1000];
    let mut i = 0;
    while i < 1000 {
        let digits = [(i / 100) as u8, (i / 10 % 10) as u8, (i % 10) as u8];
        let zeros = match digits {
            [0, 0, 0] => 3,
            [_, 0, 0] => 2,
            [_, _, 0] => 1,
            _ => 0,
        };
        triples[i] = [b'0' + digits[0], b'0' + digits[1], b'0' + digits[2], zeros];
        i += 1;
    }
    triples
};

/// Numbers of more digits take a longer way.
const DIGITS: usize = 9;

/// Room before the digits, for a space, a letter and a sign.
const HEAD: usize = 3;

/// The longest text: what is before the digits, the digits and a point.
const LONGEST: usize = HEAD + DIGITS + 1;

/// Appends `ticks / 10^decimals`: no trailing zeros, no zero before the point (`.05`, as firmwares read it).
pub(super) fn push_fixed(out: &mut Vec<u8>, ticks: i64, decimals: u32) {
    push(out, [], ticks, decimals, false);
}

/// Appends `ticks / 10^decimals`: no trailing zeros, a zero before the point (`0.05`).
pub(crate) fn push_number(out: &mut Vec<u8>, ticks: i64, decimals: u32) {
    push(out, [], ticks, decimals, true);
}

/// Appends a space, the letter and the number.
pub(super) fn push_word(out: &mut Vec<u8>, letter: u8, ticks: i64, decimals: u32) {
    match (decimals, ticks.unsigned_abs()) {
        (3, size @ 1..1_000_000) => push_short(out, letter, ticks < 0, Digits::of_3(size as u32)),
        (5, size @ 1..100_000_000) => push_short(out, letter, ticks < 0, Digits::of_5(size as u32)),
        _ => push(out, [b' ', letter], ticks, decimals, false),
    }
}

/// Digits of a number below 1000 that is not 0: most coordinates and amounts of filament.
struct Digits {
    /// In the order of a little-endian word: three before the point, the point, and those behind it.
    text: u128,
    /// How many of them are zeros before any other, or behind all others.
    leading: u32,
    trailing: u32,
    /// How many there are behind the point.
    behind: u32,
}

impl Digits {
    /// A number with 3 decimals.
    #[inline]
    fn of_3(size: u32) -> Self {
        let [whole, fraction] = [size / 1000, size % 1000];
        let (fraction, zeros) = triple(fraction);
        Self {
            text: u128::from(before_point(whole) | fraction << 32),
            leading: leading(whole),
            trailing: zeros,
            behind: 3,
        }
    }

    /// A number with 5 decimals.
    #[inline]
    fn of_5(size: u32) -> Self {
        let [whole, high, low] = [size / 100_000, size / 1000 % 100, size % 1000];
        let ((high, high_zeros), (low, low_zeros)) = (triple(high), triple(low));
        let text = u128::from(before_point(whole) | high >> 8 << 32) | u128::from(low) << 48;
        let trailing = if low_zeros == 3 { 3 + high_zeros.min(2) } else { low_zeros };
        Self { text, leading: leading(whole), trailing, behind: 5 }
    }
}

/// Three digits, and how many zeros they end in.
#[inline]
fn triple(number: u32) -> (u64, u32) {
    let triple = u32::from_le_bytes(TRIPLES[number as usize]);
    (u64::from(triple & 0xFF_FFFF), triple >> 24)
}

#[inline]
fn before_point(whole: u32) -> u64 {
    triple(whole).0 | u64::from(b'.') << 24
}

#[inline]
fn leading(whole: u32) -> u32 {
    u32::from(whole < 100) + u32::from(whole < 10) + u32::from(whole == 0)
}

/// Appends a space, the letter and a number without calls: in so many bytes there is room for all.
#[inline]
fn push_short(out: &mut Vec<u8>, letter: u8, is_negative: bool, digits: Digits) {
    let Digits { text, leading, trailing, behind } = digits;
    let head = u32::from_le_bytes([b' ', letter, b'-', 0]);
    let (head, head_bits) = if is_negative { (head, 24) } else { (head & 0xFFFF, 16) };
    let count = 3 - leading + behind - trailing + u32::from(trailing < behind);
    let length = out.len() + (head_bits / 8 + count) as usize;
    let text = u128::from(head) | text >> (8 * leading) << head_bits;
    out.extend_from_slice(&text.to_le_bytes());
    out.truncate(length);
}

/// Appends what comes before a number, and the number, at once.
fn push<const N: usize>(out: &mut Vec<u8>, before: [u8; N], ticks: i64, decimals: u32, leading_zero: bool) {
    let (size, behind) = (ticks.unsigned_abs(), decimals as usize);
    if size == 0 || size >= 10_u64.pow(DIGITS as u32) || behind >= DIGITS {
        out.extend_from_slice(&before);
        return push_any(out, ticks, decimals, leading_zero);
    }
    let size = size as u32;
    let triples = [size / 1_000_000, size / 1000 % 1000, size % 1000].map(|triple| TRIPLES[triple as usize]);
    let mut text = [0; 2 * LONGEST];
    for (k, triple) in triples.iter().enumerate() {
        // The fourth byte is written over, or is none of the number.
        text[HEAD + 3 * k..][..4].copy_from_slice(triple);
    }
    let zeros = match triples.map(|triple| usize::from(triple[3])) {
        [high, 3, 3] => 6 + high,
        [_, middle, 3] => 3 + middle,
        [_, _, low] => low,
    };
    // What is behind the point makes room for it.
    let point = HEAD + DIGITS - behind;
    let mut fraction = [0; DIGITS - 1];
    fraction.copy_from_slice(&text[point..][..DIGITS - 1]);
    text[point + 1..][..DIGITS - 1].copy_from_slice(&fraction);
    text[point] = b'.';
    let end = if zeros < behind { HEAD + DIGITS + 1 - zeros } else { point };
    let mut start = (HEAD + DIGITS - 1 - size.ilog10() as usize).min(point - usize::from(leading_zero));
    if ticks < 0 {
        start -= 1;
        text[start] = b'-';
    }
    start -= N;
    text[start..][..N].copy_from_slice(&before);
    // So many bytes are copied without a call.
    let (length, mut longest) = (out.len() + end - start, [0; LONGEST]);
    longest.copy_from_slice(&text[start..][..LONGEST]);
    out.extend_from_slice(&longest);
    out.truncate(length);
}

/// Appends any number.
fn push_any(out: &mut Vec<u8>, ticks: i64, decimals: u32, leading_zero: bool) {
    let (sign, decimals) = (if ticks < 0 { "-" } else { "" }, decimals as usize);
    let digits = format!("{:0>1$}", ticks.unsigned_abs(), decimals + 1);
    let (whole, fraction) = digits.split_at(digits.len() - decimals);
    let fraction = fraction.trim_end_matches('0');
    let whole = if whole == "0" && !leading_zero && !fraction.is_empty() { "" } else { whole };
    let point = if fraction.is_empty() { "" } else { "." };
    out.extend([sign, whole, point, fraction].concat().bytes());
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
        fn words_have_the_same_numbers(
            size in prop_oneof![0..2000_i64, 0..2_000_000_i64, 0..200_000_000_i64],
            round in 0..6_u32,
            negative: bool,
            decimals in 0..6_u32,
        ) {
            let step = 10_i64.pow(round);
            let ticks = if negative { -1 } else { 1 } * (size / step * step);
            let mut out = b"G1".to_vec();
            push_word(&mut out, b'X', ticks, decimals);
            prop_assert_eq!(String::from_utf8(out).expect("digits"), format!("G1 X{}", fixed(ticks, decimals)));
        }

        #[test]
        fn they_read_back_as_what_was_written(ticks in -10_000_000_000..10_000_000_000_i64, decimals in 0..6_u32) {
            let value: f64 = fixed(ticks, decimals).parse().expect("a number");
            prop_assert_eq!((value * 10_f64.powi(decimals as i32)).round() as i64, ticks);
        }
    }
}
