//! Text as blank-separated words.

/// A number, with a decimal comma if need be.
pub(super) fn number(word: &[u8]) -> Option<f32> {
    let text = std::str::from_utf8(word).ok()?;
    text.parse().ok().or_else(|| text.replace(',', ".").parse().ok())
}

/// Blank-separated words with the line they stand on; lines end with LF, CR LF or CR.
pub(super) struct Words<'a> {
    data: &'a [u8],
    at: usize,
    /// Line of the word read last, from 1.
    pub line: usize,
}

impl<'a> Words<'a> {
    /// The words of a file, after its byte order mark if there is one.
    pub fn new(data: &'a [u8]) -> Self {
        Self { data: data.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(data), at: 0, line: 1 }
    }

    /// The next word, on whatever line.
    pub fn next(&mut self) -> Option<&'a [u8]> {
        while self.data.get(self.at)?.is_ascii_whitespace() {
            self.line += usize::from(self.ends_line());
            self.at += 1;
        }
        let rest = &self.data[self.at..];
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.at += length;
        Some(&rest[..length])
    }

    /// The next word, if it stands on the same line or on one that this one goes on in.
    ///
    /// A backslash at the end of a line says that it goes on.
    pub fn next_on_joined_lines(&mut self) -> Option<&'a [u8]> {
        let word = self.next_on_line()?;
        let is_end = self.data.get(self.at).is_none_or(|b| matches!(b, b'\n' | b'\r'));
        if word != b"\\" || !is_end {
            return Some(word);
        }
        while self.data.get(self.at).is_some_and(|b| matches!(b, b'\n' | b'\r')) {
            let ends = self.ends_line();
            self.line += usize::from(ends);
            self.at += 1;
            if ends {
                break;
            }
        }
        self.next_on_joined_lines()
    }

    /// The next word, if it stands on the same line.
    pub fn next_on_line(&mut self) -> Option<&'a [u8]> {
        while self.data.get(self.at).is_some_and(|b| matches!(b, b' ' | b'\t')) {
            self.at += 1;
        }
        if self.data.get(self.at).is_none_or(u8::is_ascii_whitespace) { None } else { self.next() }
    }

    /// Passes over the rest of the line.
    pub fn skip_line(&mut self) {
        let rest = &self.data[self.at..];
        self.at += rest.iter().position(|b| matches!(b, b'\n' | b'\r')).unwrap_or(rest.len());
    }

    fn ends_line(&self) -> bool {
        match self.data[self.at] {
            b'\n' => true,
            b'\r' => self.data.get(self.at + 1) != Some(&b'\n'),
            _ => false,
        }
    }
}
