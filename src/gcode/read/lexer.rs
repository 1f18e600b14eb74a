//! Lines, codes, words and comments.

use memchr::memchr;

/// Numbers of more characters are not plain.
const LONGEST_PLAIN: usize = 20;

/// A letter and its number: G1, M104, T0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Code {
    /// G, M or T.
    pub letter: u8,
    /// What follows it.
    pub number: u32,
}

/// The parameters of a command: at most one value for each letter, the last one given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Words {
    given: u32,
    /// Whether they are written in another form than slicers write nearly all.
    odd: bool,
    values: [f64; 26],
}

impl Default for Words {
    fn default() -> Self {
        Self { given: 0, odd: false, values: [0.0; 26] }
    }
}

impl Words {
    /// The value of an upper-case letter.
    #[inline]
    pub fn get(&self, letter: u8) -> Option<f64> {
        let at = letter.wrapping_sub(b'A');
        (at < 26 && self.given >> at & 1 == 1).then(|| self.values[usize::from(at)])
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.given == 0
    }

    /// Whether they are written as slicers write nearly all moves: letters of moves in capitals, each behind one blank
    /// and with a number behind it, none twice.
    pub fn are_plain(&self) -> bool {
        const MOVES: u32 = letters(b"EFIJRXYZ");
        !self.odd && self.given & !MOVES == 0
    }

    fn set(&mut self, letter: u8, value: f64) {
        let at = letter.to_ascii_uppercase().wrapping_sub(b'A');
        if at < 26 {
            self.given |= 1 << at;
            self.values[usize::from(at)] = value;
        }
    }
}

/// One line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line<'a> {
    /// Number of the line, from 1.
    pub number: usize,
    /// Bytes of the text before it.
    pub offset: usize,
    /// All of it, with its end.
    pub raw: &'a [u8],
    /// All of it, without its end.
    pub text: &'a [u8],
    /// Its command; `None` of blank lines, comments and commands with names (Klipper's).
    pub code: Option<Code>,
    /// What follows the code, up to a comment.
    parameters: &'a [u8],
    /// What follows the semicolon.
    pub comment: Option<&'a [u8]>,
}

impl<'a> Line<'a> {
    /// Nothing.
    pub(crate) const EMPTY: Self =
        Self { number: 0, offset: 0, raw: b"", text: b"", code: None, parameters: b"", comment: None };

    /// Takes one line apart. `raw` holds no line end but its own, if it has one.
    pub fn new(number: usize, offset: usize, raw: &'a [u8]) -> Self {
        let line = raw.strip_suffix(b"\n").unwrap_or(raw);
        let text = line.strip_suffix(b"\r").unwrap_or(line);
        let (command, comment) = match memchr(b';', text) {
            Some(at) => (&text[..at], Some(&text[at + 1..])),
            None => (text, None),
        };
        let (code, parameters) = code(command);
        Self { number, offset, raw, text, code, parameters, comment }
    }

    /// The line at another place.
    pub(crate) fn placed(self, number: usize, offset: usize) -> Self {
        Self { number, offset, ..self }
    }

    /// Whether the code is this one, such as `(b'M', 204)`.
    pub fn is(&self, letter: u8, number: u32) -> bool {
        self.code == Some(Code { letter, number })
    }

    /// What follows the code, up to a comment.
    pub fn parameters(&self) -> &'a [u8] {
        self.parameters
    }

    /// Whether an axis, by its capital letter, is named, with or without a number.
    pub fn names(&self, axis: u8) -> bool {
        self.parameters.iter().any(|byte| byte.to_ascii_uppercase() == axis)
    }

    /// The command's parameters.
    #[inline]
    pub fn words(&self) -> Words {
        let mut words = Words::default();
        self.read_words(&mut words);
        words
    }

    fn read_words(&self, words: &mut Words) {
        let mut odd = false;
        // Numbers end before a comment and before the line's end, so the whole line can be looked at.
        let (bytes, end) = (self.raw, self.text.len() - self.comment.map_or(0, |comment| comment.len() + 1));
        let mut cursor = Cursor { bytes, at: end - self.parameters.len() };
        while cursor.at < end {
            let byte = bytes[cursor.at];
            cursor.at += 1;
            let mut letter = byte;
            if let (b' ', Some(next @ b'A'..=b'Z')) = (byte, bytes.get(cursor.at)) {
                cursor.at += 1;
                letter = *next;
                odd |= words.get(letter).is_some();
            } else {
                odd = true;
                // An expression of RepRapFirmware: letters in it are no words.
                if byte == b'{' {
                    let inside = bytes[cursor.at..end].iter().position(|b| *b == b'}');
                    cursor.at = inside.map_or(end, |inside| cursor.at + inside + 1);
                }
            }
            if letter.is_ascii_alphabetic() {
                let begin = cursor.at;
                cursor.skip_blanks();
                let value = cursor.number();
                if let Some(value) = value {
                    words.set(letter, value);
                }
                odd |= value.is_none()
                    || cursor.at - begin > LONGEST_PLAIN
                    || matches!(bytes[begin], b'+' | b' ' | b'\t');
            }
        }
        words.odd = odd;
    }
}

/// The lines of a text, ended by `\n` or `\r\n`.
pub fn lines(text: &[u8]) -> Lines<'_> {
    Lines { rest: text, number: 0, offset: 0 }
}

/// Iterator of [`lines`].
#[derive(Clone, Debug)]
pub struct Lines<'a> {
    rest: &'a [u8],
    number: usize,
    offset: usize,
}

impl<'a> Iterator for Lines<'a> {
    type Item = Line<'a>;

    fn next(&mut self) -> Option<Line<'a>> {
        if self.rest.is_empty() {
            return None;
        }
        self.number += 1;
        let end = memchr(b'\n', self.rest).map_or(self.rest.len(), |at| at + 1);
        let (raw, rest) = self.rest.split_at(end);
        self.rest = rest;
        let offset = self.offset;
        self.offset += end;
        Some(Line::new(self.number, offset, raw))
    }
}

/// A bit for each of some upper-case letters.
const fn letters(names: &[u8]) -> u32 {
    let (mut bits, mut at) = (0, 0);
    while at < names.len() {
        bits |= 1 << (names[at] - b'A');
        at += 1;
    }
    bits
}

/// The code that a command begins with, and what follows it.
fn code(command: &[u8]) -> (Option<Code>, &[u8]) {
    // Nearly all: G1.
    if let [b'G', digit @ b'0'..=b'9', rest @ ..] = command
        && !rest.first().is_some_and(u8::is_ascii_digit)
    {
        return (Some(Code { letter: b'G', number: u32::from(digit - b'0') }), rest);
    }
    let command = command.trim_ascii_start();
    let [letter @ (b'G' | b'M' | b'T' | b'g' | b'm' | b't'), digits @ ..] = command else {
        return (None, command);
    };
    let count = digits.iter().take_while(|b| b.is_ascii_digit()).count();
    if count == 0 {
        return (None, command);
    }
    let number = digits[..count]
        .iter()
        .fold(0_u32, |number, digit| number.saturating_mul(10).saturating_add(u32::from(digit - b'0')));
    (Some(Code { letter: letter.to_ascii_uppercase(), number }), &digits[count..])
}

const POWERS: [f64; 8] = [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7];
const WHOLE_POWERS: [i64; 8] = [1, 10, 100, 1000, 10_000, 100_000, 1_000_000, 10_000_000];

struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Cursor<'_> {
    fn skip_blanks(&mut self) {
        while self.bytes.get(self.at).is_some_and(|b| matches!(b, b' ' | b'\t')) {
            self.at += 1;
        }
    }

    /// A decimal number without exponent (E is a word of its own). Exact up to 15 digits; decimals beyond the
    /// seventeenth digit are dropped.
    #[inline]
    fn number(&mut self) -> Option<f64> {
        let bytes = self.bytes;
        let first = bytes.get(self.at);
        let negative = first == Some(&b'-');
        let begin = self.at + usize::from(negative || first == Some(&b'+'));
        let digits = short_number(eight(bytes, begin)).or_else(|| usual_number(&bytes[begin..]));
        let (value, length) = match digits {
            Some(digits) => (digits.mantissa as f64 / POWERS[digits.decimals & 7], digits.length),
            None => long_number(&bytes[begin..]),
        };
        if length == 0 {
            return None;
        }
        self.at = begin + length;
        Some(if negative { -value } else { value })
    }
}

/// The eight bytes from a position on; zeros behind the end.
fn eight(bytes: &[u8], at: usize) -> u64 {
    let rest = bytes.get(at..).unwrap_or_default();
    match (rest.first_chunk(), bytes.last_chunk()) {
        (Some(chunk), _) => u64::from_le_bytes(*chunk),
        (None, Some(chunk)) if !rest.is_empty() => u64::from_le_bytes(*chunk) >> (64 - 8 * rest.len()),
        _ => rest.iter().rev().fold(0, |word, byte| word << 8 | u64::from(*byte)),
    }
}

/// The top bit of each of eight bytes.
const TOPS: u64 = 0x8080_8080_8080_8080;

/// The top bits of those of eight bytes that are no digits, and the values of those that are.
#[inline]
fn tell_digits(word: u64) -> (u64, u64) {
    let values = word ^ 0x3030_3030_3030_3030;
    // What is more than nine reaches the top bit of its byte.
    ((((values & !TOPS) + 0x7676_7676_7676_7676) | values) & TOPS, values)
}

/// Which of eight bytes is the first whose top bit is set.
#[inline]
fn first(tops: u64) -> Option<usize> {
    (tops != 0).then(|| tops.trailing_zeros() as usize / 8)
}

/// The number that the first of eight values of digits make, one at least.
#[inline]
fn joined(values: u64, count: usize) -> i64 {
    let values = values << (64 - 8 * count);
    let pairs = values.wrapping_mul(10).wrapping_add(values >> 8);
    let [low, high] = [pairs, pairs >> 16].map(|pairs| pairs & 0x0000_00ff_0000_00ff);
    let sum = low.wrapping_mul(0x000f_4240_0000_0064).wrapping_add(high.wrapping_mul(0x0000_2710_0000_0001));
    (sum >> 32) as i64
}

/// A number without sign.
#[derive(Clone, Copy, Default)]
struct Digits {
    /// All its digits as one whole number, and how many of them are decimals.
    mantissa: i64,
    decimals: usize,
    /// Its length; 0: there is no digit.
    length: usize,
}

/// The number that eight bytes begin with; `None` if it does not end there.
#[inline]
fn short_number(word: u64) -> Option<Digits> {
    let (others, values) = tell_digits(word);
    let whole = first(others)?;
    let (length, decimals, values) = if (word >> (8 * whole)) as u8 == b'.' {
        let length = first(others & (others - 1))?;
        // The decimals move up to the digits before the point.
        let before = (1 << (8 * whole)) - 1;
        (length, length - whole - 1, values & before | values >> 8 & !before)
    } else {
        (whole, 0, values)
    };
    let count = length - usize::from(length > whole);
    if count == 0 {
        return Some(Digits::default());
    }
    Some(Digits { mantissa: joined(values, count), decimals, length })
}

/// The number that some bytes begin with, which does not end within eight; `None` if it has more than seven digits before
/// or behind the point.
fn usual_number(bytes: &[u8]) -> Option<Digits> {
    let part = |at: usize| {
        let (others, values) = tell_digits(eight(bytes, at));
        let count = first(others)?;
        Some((count, if count > 0 { joined(values, count) } else { 0 }))
    };
    let (whole, mantissa) = part(0)?;
    if bytes.get(whole) != Some(&b'.') {
        return Some(Digits { mantissa, decimals: 0, length: whole });
    }
    let (decimals, value) = part(whole + 1)?;
    Some(Digits {
        mantissa: mantissa * WHOLE_POWERS[decimals] + value,
        decimals,
        length: whole + 1 + decimals,
    })
}

/// The value of a number of any length, and its length.
fn long_number(bytes: &[u8]) -> (f64, usize) {
    const MOST: u64 = 100_000_000_000_000_000;
    let (mut mantissa, mut scale, mut point, mut length) = (0_u64, 1.0, false, 0);
    for &byte in bytes {
        match byte {
            b'.' if !point => point = true,
            b'0'..=b'9' if mantissa < MOST => {
                mantissa = mantissa * 10 + u64::from(byte - b'0');
                scale *= if point { 10.0 } else { 1.0 };
            }
            b'0'..=b'9' if !point => {
                mantissa = mantissa.saturating_mul(10).saturating_add(u64::from(byte - b'0'));
            }
            b'0'..=b'9' => {}
            _ => break,
        }
        length += 1;
    }
    (mantissa as f64 / scale, length)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn first(text: &str) -> Line<'_> {
        lines(text.as_bytes()).next().expect("a line")
    }

    #[test]
    fn a_move_is_taken_apart() {
        let line = first("  g01 X-1.5y.25 E 3 ; TYPE:x\r\nG28");
        assert_eq!(line.code, Some(Code { letter: b'G', number: 1 }));
        assert_eq!(
            [b'X', b'Y', b'E', b'Z'].map(|w| line.words().get(w)),
            [Some(-1.5), Some(0.25), Some(3.0), None]
        );
        assert_eq!(line.comment, Some(&b" TYPE:x"[..]));
    }

    #[test]
    fn letters_of_an_expression_are_no_words() {
        let words = first("G1 X{global.e1 + 5} Y3 F{var.f2}").words();
        assert_eq!([b'X', b'E', b'Y', b'F'].map(|w| words.get(w)), [None, None, Some(3.0), None]);
    }

    #[test]
    fn every_line_is_seen_whatever_its_end() {
        let codes: Vec<_> =
            lines(b"G1\r\n\n;c\nSET_X A=1\nT0").map(|l| (l.number, l.code.map(|c| c.number))).collect();
        assert_eq!(codes, [(1, Some(1)), (2, None), (3, None), (4, None), (5, Some(0))]);
    }

    #[test]
    fn plain_words_are_told_apart() {
        let plain = |text: &str| first(&format!("G1{text}")).words().are_plain();
        for text in ["", " X1 Y-2.5 E.03 F1200", " Z1. ; c", " X1;c\r\n"] {
            assert_eq!(plain(text), !text.contains(" ;"), "{text}");
        }
        for text in
            ["X1", " x1", " X 1", " X+1", " X", " X1 X2", " X1.2.3", " X1e5", " S1", "\tX1", " X1  Y2"]
        {
            assert!(!plain(text), "{text}");
        }
    }

    #[test]
    fn numbers_of_any_length_are_read_to_their_end() {
        for number in
            ["1", "-.5", "1234567.1234567", "12345678", "0.12345678", "123456789.123456789", "00000000001.5"]
        {
            let words = [format!("G1 X{number}"), format!("G1 X{number} Y7 ; and more\n")]
                .map(|line| first(&line).words());
            assert_eq!(words.map(|words| words.get(b'X')), [number.parse().ok(); 2], "{number}");
            assert_eq!(words[1].get(b'Y'), Some(7.0), "{number}");
        }
    }

    proptest! {
        #[test]
        fn numbers_are_read_exactly(ticks in -99_999_999_999_i64..99_999_999_999) {
            let text = format!("{:.5}", ticks as f64 / 1e5);
            let line = format!("G1 X{text}");
            prop_assert_eq!(first(&line).words().get(b'X'), text.parse().ok());
        }

        #[test]
        fn no_bytes_upset_it(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
            let count = lines(&bytes).count();
            let ends = bytes.iter().filter(|b| **b == b'\n').count();
            prop_assert!(count == ends + usize::from(bytes.last().is_some_and(|b| *b != b'\n')));
        }
    }
}
