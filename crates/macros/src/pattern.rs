//! Regular expressions.

use std::borrow::Cow;
use std::sync::OnceLock;

use regex_lite::{Regex, RegexBuilder};

use crate::limits;

/// A regular expression of bytes that must match the whole of a text; a dot matches line ends as well.
///
/// It is compiled when it is first needed, and once.
#[derive(Debug)]
pub struct Pattern {
    text: String,
    compiled: OnceLock<Result<Regex, String>>,
}

impl Pattern {
    /// What stands between the slashes.
    pub fn new(text: String) -> Self {
        Self { text, compiled: OnceLock::new() }
    }

    /// Whether a text matches as a whole, or why the expression is none.
    pub fn matches(&self, text: &str) -> Result<bool, String> {
        match self.compiled.get_or_init(|| compile(&self.text)) {
            Ok(regex) => Ok(regex.is_match(&bytes(text))),
            Err(why) => Err(why.clone()),
        }
    }
}

fn compile(text: &str) -> Result<Regex, String> {
    let build = |text: &str| {
        RegexBuilder::new(text)
            .dot_matches_new_line(true)
            .size_limit(limits::PATTERN)
            .build()
            .map_err(|error| error.to_string())
    };
    let text = &*bytes(text);
    // A bracket too many must not close the one that is put around.
    if text.contains(')') {
        build(text)?;
    }
    build(&format!(r"\A(?:{text})\z"))
}

/// A character for each byte.
fn bytes(text: &str) -> Cow<'_, str> {
    if text.is_ascii() { text.into() } else { text.bytes().map(char::from).collect() }
}
