//! Text → tokens of the code between braces.

use crate::error::{Error, ErrorKind};
use crate::limits;
use crate::pattern::Pattern;

#[derive(Clone, Debug, PartialEq)]
pub enum Token<'a> {
    /// A name or a keyword.
    Word(&'a str),
    Integer(i64),
    Real(f64),
    Text(String),
    /// An operator or a bracket.
    Sign(&'static str),
    End,
}

/// Longer ones first.
const SIGNS: &[&str] = &[
    "<=", ">=", "<>", "==", "!=", "=~", "!~", "&&", "||", "(", ")", "[", "]", "{", "}", ",", ";", "?", ":",
    "+", "-", "*", "/", "%", "<", ">", "=", "!", "~",
];

/// Reads tokens one after the other.
pub struct Scanner<'a> {
    pub source: &'a str,
    /// The token that is looked at, and which bytes it is.
    pub token: Token<'a>,
    pub start: usize,
    pub end: usize,
    depth: usize,
}

/// A place in the script to go back to.
pub struct Mark<'a>(Token<'a>, usize, usize);

impl<'a> Scanner<'a> {
    /// Before the first token.
    pub fn new(source: &'a str) -> Result<Self, Error> {
        let scanner = Self { source, token: Token::End, start: 0, end: 0, depth: 0 };
        match source.len() > limits::SCRIPT {
            true => Err(scanner.error(0, ErrorKind::Limit, "the script is longer than a megabyte")),
            false => Ok(scanner),
        }
    }

    pub fn error(&self, at: usize, kind: ErrorKind, message: impl Into<String>) -> Error {
        Error::at(self.source, at, kind, message)
    }

    /// Something else should be where the token is.
    pub fn expected(&self, what: &str) -> Error {
        let found = match &self.token {
            Token::End => "the end of the script".to_owned(),
            _ => format!("`{}`", self.source[self.start..self.end].chars().take(40).collect::<String>()),
        };
        self.error(self.start, ErrorKind::Syntax, format!("expected {what}, found {found}"))
    }

    /// Looks at the first token from a byte on.
    pub fn enter(&mut self, at: usize) -> Result<(), Error> {
        self.end = at;
        self.advance()
    }

    pub fn mark(&self) -> Mark<'a> {
        Mark(self.token.clone(), self.start, self.end)
    }

    pub fn back(&mut self, mark: Mark<'a>) {
        (self.token, self.start, self.end) = (mark.0, mark.1, mark.2);
    }

    /// Looks at the next token.
    pub fn advance(&mut self) -> Result<(), Error> {
        let rest = &self.source[self.end..];
        self.start = self.end + rest.len() - rest.trim_start_matches([' ', '\t', '\r', '\n']).len();
        let rest = &self.source[self.start..];
        let (token, length) = match rest.bytes().next() {
            None => (Token::End, 0),
            Some(b'a'..=b'z' | b'A'..=b'Z' | b'_') => {
                let length = run(rest, |c| c.is_ascii_alphanumeric() || c == '_');
                (Token::Word(&rest[..length]), length)
            }
            Some(b'"') => self.text()?,
            Some(b'0'..=b'9') => self.number()?,
            Some(b'.') if rest[1..].starts_with(|c: char| c.is_ascii_digit()) => self.number()?,
            Some(_) => match SIGNS.iter().find(|sign| rest.starts_with(**sign)) {
                Some(sign) => (Token::Sign(sign), sign.len()),
                None => {
                    let c = rest.chars().next().unwrap_or_default();
                    let message =
                        format!("`{c}` has no meaning in code; it may stand in text and between quotes");
                    return Err(self.error(self.start, ErrorKind::Syntax, message));
                }
            },
        };
        self.end = self.start + length;
        self.token = token;
        Ok(())
    }

    /// Digits with a point or an exponent are a real number; one of both is enough.
    fn number(&self) -> Result<(Token<'a>, usize), Error> {
        let rest = &self.source[self.start..];
        let digits = |text: &str| run(text, |c| c.is_ascii_digit());
        let mut length = digits(rest);
        let mut real = false;
        if rest[length..].starts_with('.') {
            length += 1 + digits(&rest[length + 1..]);
            real = true;
        }
        if rest[length..].starts_with(['e', 'E']) {
            let signed = usize::from(rest[length + 1..].starts_with(['+', '-']));
            let power = digits(&rest[length + 1 + signed..]);
            if power > 0 {
                length += 1 + signed + power;
                real = true;
            }
        }
        let text = &rest[..length];
        let token = match real {
            true => text.parse().ok().filter(|real: &f64| real.is_finite()).map(Token::Real),
            false => text.parse().ok().map(Token::Integer),
        };
        let token =
            token.ok_or_else(|| self.error(self.start, ErrorKind::Overflow, "the number is too large"))?;
        Ok((token, length))
    }

    /// A text in quotes.
    fn text(&self) -> Result<(Token<'a>, usize), Error> {
        let rest = &self.source[self.start..];
        let mut text = String::new();
        let mut chars = rest.char_indices().skip(1);
        while let Some((at, c)) = chars.next() {
            match c {
                '"' => return Ok((Token::Text(text), at + 1)),
                '\\' => text.push(match chars.next() {
                    Some((_, 'n')) => '\n',
                    Some((_, 'r')) => '\r',
                    Some((_, c @ ('"' | '\\'))) => c,
                    _ => {
                        let message = r#"after a backslash must come `n`, `r`, `"` or another backslash"#;
                        return Err(self.error(self.start + at, ErrorKind::Syntax, message));
                    }
                }),
                c => text.push(c),
            }
        }
        Err(self.error(self.start, ErrorKind::Syntax, "the text has no closing quote"))
    }

    /// The regular expression that begins with the slash at or after a byte; then looks at the next token.
    pub fn pattern(&mut self, from: usize) -> Result<(Pattern, usize), Error> {
        let rest = &self.source[from..];
        let at = from + rest.len() - rest.trim_start_matches([' ', '\t', '\r', '\n']).len();
        let Some(rest) = self.source[at..].strip_prefix('/') else {
            let message = "expected a regular expression between slashes, such as `/.*MK4.*/`";
            return Err(self.error(at, ErrorKind::Syntax, message));
        };
        let mut escaped = false;
        let close = rest.find(|c| {
            let closes = c == '/' && !escaped;
            escaped = c == '\\' && !escaped;
            closes
        });
        let Some(close) = close else {
            return Err(self.error(at, ErrorKind::Syntax, "the regular expression has no closing slash"));
        };
        self.enter(at + 1 + close + 1)?;
        Ok((Pattern::new(rest[..close].to_owned()), at))
    }

    pub fn is_sign(&self, sign: &str) -> bool {
        matches!(self.token, Token::Sign(found) if found == sign)
    }

    pub fn is_word(&self, word: &str) -> bool {
        matches!(self.token, Token::Word(found) if found == word)
    }

    /// Goes over a sign if it is there.
    pub fn skip_sign(&mut self, sign: &str) -> Result<bool, Error> {
        let there = self.is_sign(sign);
        if there {
            self.advance()?;
        }
        Ok(there)
    }

    /// Goes over a sign that must be there.
    pub fn need_sign(&mut self, sign: &str) -> Result<(), Error> {
        match self.skip_sign(sign)? {
            true => Ok(()),
            false => Err(self.expected(&format!("`{sign}`"))),
        }
    }

    /// Reads something that stands within something else.
    pub fn nested<T>(&mut self, read: impl FnOnce(&mut Self) -> Result<T, Error>) -> Result<T, Error> {
        self.deeper()?;
        let result = read(self);
        self.shallower();
        result
    }

    /// One level further in.
    pub fn deeper(&mut self) -> Result<(), Error> {
        if self.depth == limits::DEPTH {
            let message = format!("more than {} levels within each other", limits::DEPTH);
            return Err(self.error(self.start, ErrorKind::Limit, message));
        }
        self.depth += 1;
        Ok(())
    }

    /// One level out again.
    pub fn shallower(&mut self) {
        self.depth -= 1;
    }
}

/// How many bytes of the beginning are such characters.
fn run(text: &str, is: impl Fn(char) -> bool) -> usize {
    text.find(|c| !is(c)).unwrap_or(text.len())
}
