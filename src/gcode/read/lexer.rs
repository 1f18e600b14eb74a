//! Lines, codes, words and comments.

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
    values: [f64; 26],
}

impl Default for Words {
    fn default() -> Self {
        Self { given: 0, values: [0.0; 26] }
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
    /// All of it, without its end.
    pub text: &'a [u8],
    /// Its command; `None` of blank lines, comments and commands with names (Klipper's).
    pub code: Option<Code>,
    /// The command's parameters.
    pub words: Words,
    /// What follows the semicolon.
    pub comment: Option<&'a [u8]>,
}

/// The lines of a text, ended by `\n` or `\r\n`.
pub fn lines(text: &[u8]) -> Lines<'_> {
    Lines { rest: text, number: 0 }
}

/// Iterator of [`lines`].
#[derive(Clone, Debug)]
pub struct Lines<'a> {
    rest: &'a [u8],
    number: usize,
}

impl<'a> Iterator for Lines<'a> {
    type Item = Line<'a>;

    fn next(&mut self) -> Option<Line<'a>> {
        if self.rest.is_empty() {
            return None;
        }
        self.number += 1;
        let mut cursor = Cursor { bytes: self.rest, at: 0 };
        let (code, words) = cursor.command();
        cursor.skip_to_end();
        let comment_at = (cursor.peek() == b';').then_some(cursor.at + 1);
        let end = match comment_at {
            Some(from) => {
                from + self.rest[from..].iter().position(|b| *b == b'\n').unwrap_or(self.rest.len() - from)
            }
            None => cursor.at,
        };
        let text = self.rest[..end].strip_suffix(b"\r").unwrap_or(&self.rest[..end]);
        let comment = comment_at.map(|from| &text[from.min(text.len())..]);
        self.rest = self.rest.get(end + 1..).unwrap_or_default();
        Some(Line { number: self.number, text, code, words, comment })
    }
}

struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Cursor<'_> {
    /// The byte at the cursor; the end of the text reads as an end of line.
    #[inline]
    fn peek(&self) -> u8 {
        self.bytes.get(self.at).copied().unwrap_or(b'\n')
    }

    fn skip_blanks(&mut self) {
        while matches!(self.peek(), b' ' | b'\t') {
            self.at += 1;
        }
    }

    /// To the comment or the end of the line.
    fn skip_to_end(&mut self) {
        while !matches!(self.peek(), b'\n' | b';') {
            self.at += 1;
        }
    }

    fn command(&mut self) -> (Option<Code>, Words) {
        let mut words = Words::default();
        self.skip_blanks();
        let letter = self.peek().to_ascii_uppercase();
        if !matches!(letter, b'G' | b'M' | b'T')
            || !self.bytes.get(self.at + 1).is_some_and(u8::is_ascii_digit)
        {
            return (None, words);
        }
        self.at += 1;
        let mut number = 0_u32;
        while self.peek().is_ascii_digit() {
            number = number.saturating_mul(10).saturating_add(u32::from(self.peek() - b'0'));
            self.at += 1;
        }
        loop {
            match self.peek() {
                b'\n' | b';' => break,
                letter if letter.is_ascii_alphabetic() => {
                    self.at += 1;
                    self.skip_blanks();
                    if let Some(value) = self.number() {
                        words.set(letter, value);
                    }
                }
                _ => self.at += 1,
            }
        }
        (Some(Code { letter, number }), words)
    }

    /// A decimal number without exponent (E is a word of its own). Exact up to 15 digits; decimals beyond the
    /// seventeenth digit are dropped.
    fn number(&mut self) -> Option<f64> {
        const POWERS: [f64; 23] = [
            1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17,
            1e18, 1e19, 1e20, 1e21, 1e22,
        ];
        let start = self.at;
        let negative = self.peek() == b'-';
        if matches!(self.peek(), b'-' | b'+') {
            self.at += 1;
        }
        let (mut mantissa, mut digits, mut decimals, mut point) = (0_u64, 0_usize, 0_usize, false);
        loop {
            match self.peek() {
                digit @ b'0'..=b'9' => {
                    digits += 1;
                    if mantissa < 100_000_000_000_000_000 || !point {
                        mantissa = mantissa.saturating_mul(10).saturating_add(u64::from(digit - b'0'));
                        decimals += usize::from(point);
                    }
                }
                b'.' if !point => point = true,
                _ => break,
            }
            self.at += 1;
        }
        if digits == 0 {
            self.at = start;
            return None;
        }
        let value = mantissa as f64 / POWERS[decimals.min(22)];
        Some(if negative { -value } else { value })
    }
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
            [b'X', b'Y', b'E', b'Z'].map(|w| line.words.get(w)),
            [Some(-1.5), Some(0.25), Some(3.0), None]
        );
        assert_eq!(line.comment, Some(&b" TYPE:x"[..]));
    }

    #[test]
    fn every_line_is_seen_whatever_its_end() {
        let codes: Vec<_> =
            lines(b"G1\r\n\n;c\nSET_X A=1\nT0").map(|l| (l.number, l.code.map(|c| c.number))).collect();
        assert_eq!(codes, [(1, Some(1)), (2, None), (3, None), (4, None), (5, Some(0))]);
    }

    proptest! {
        #[test]
        fn numbers_are_read_exactly(ticks in -99_999_999_999_i64..99_999_999_999) {
            let text = format!("{:.5}", ticks as f64 / 1e5);
            let line = format!("G1 X{text}");
            prop_assert_eq!(first(&line).words.get(b'X'), text.parse().ok());
        }

        #[test]
        fn no_bytes_upset_it(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
            let count = lines(&bytes).count();
            let ends = bytes.iter().filter(|b| **b == b'\n').count();
            prop_assert!(count == ends + usize::from(bytes.last().is_some_and(|b| *b != b'\n')));
        }
    }
}
