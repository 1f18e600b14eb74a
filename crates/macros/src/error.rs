//! What is wrong with a script, and where.

use std::fmt::{self, Display, Formatter};

/// What kind of mistake a script has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorKind {
    /// Neither a placeholder nor a variable has this name.
    UnknownName,
    /// The text is no script: something is not closed, missing or out of place.
    Syntax,
    /// A value is of a type that does not go with what is done to it.
    Type,
    /// A number is divided by zero.
    Division,
    /// A number is too large.
    Overflow,
    /// A vector has no such element.
    Index,
    /// An optional value is used that is not set.
    Nil,
    /// A name cannot be assigned to, or is taken.
    Assignment,
    /// A regular expression is not understood, or too large.
    Pattern,
    /// A table cannot be interpolated at this place.
    Table,
    /// The script is too long, nested too deeply, writes or computes too much.
    Limit,
}

/// What is wrong with a script, and where.
///
/// ```
/// use pathwright_macros::{State, Value, expand};
///
/// let names = std::collections::BTreeMap::from([("temperature".to_owned(), Value::Integer(215))]);
/// let error = expand("G28\nM104 S{temprature}", &names, &mut State::default()).unwrap_err();
/// assert_eq!(
///     error.to_string(),
///     "line 2, column 8: unknown name `temprature`; did you mean `temperature`?"
/// );
/// ```
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub struct Error {
    /// The line of the script, from 1.
    pub line: usize,
    /// The character in the line, from 1.
    pub column: usize,
    /// What kind of mistake it is.
    pub kind: ErrorKind,
    /// What is wrong, in words.
    pub message: String,
    /// The known name nearest to an unknown one.
    pub near: Option<String>,
}

impl Error {
    /// A mistake at a byte of a script.
    pub(crate) fn at(script: &str, at: usize, kind: ErrorKind, message: impl Into<String>) -> Self {
        let before = script.get(..at).unwrap_or(script);
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
        Self { line, column, kind, message: message.into(), near: None }
    }

    /// The same with a name that may have been meant.
    pub(crate) fn with_near(self, near: Option<String>) -> Self {
        Self { near, ..self }
    }
}

impl Display for Error {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        write!(out, "line {}, column {}: {}", self.line, self.column, self.message)?;
        match &self.near {
            Some(near) => write!(out, "; did you mean `{near}`?"),
            None => Ok(()),
        }
    }
}
