//! What an expansion knows and how much it may still do.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

use crate::error::{Error, ErrorKind};
use crate::near::nearest;
use crate::pattern::Pattern;
use crate::state::State;
use crate::syntax::{Expression, KEYWORDS};
use crate::{Names, Value, limits};

/// What makes a value of an expression.
pub type Evaluate = fn(&mut Context<'_>, &Expression) -> Result<Value, Error>;

/// An expansion under way.
pub struct Context<'a> {
    pub source: &'a str,
    pub names: &'a dyn Names,
    pub state: &'a mut State,
    pub locals: BTreeMap<String, Value>,
    /// Unknown names that `exists` was asked for, which from then on are false.
    pub asked: BTreeSet<String>,
    /// `ignore_legacy(true)`: brackets are text.
    pub ignores_brackets: bool,
    pub output: String,
    work: usize,
    patterns: usize,
    matched: usize,
}

impl<'a> Context<'a> {
    pub fn new(source: &'a str, names: &'a dyn Names, state: &'a mut State) -> Self {
        state.written.clear();
        Self {
            source,
            names,
            state,
            locals: BTreeMap::new(),
            asked: BTreeSet::new(),
            ignores_brackets: false,
            output: String::new(),
            work: 0,
            patterns: 0,
            matched: 0,
        }
    }

    pub fn error(&self, at: usize, kind: ErrorKind, message: impl Into<String>) -> Error {
        Error::at(self.source, at, kind, message)
    }

    /// A value of a type that does not go here.
    pub fn wrong(&self, at: usize, needs: &str, found: &Value) -> Error {
        self.error(at, ErrorKind::Type, format!("{needs}, not {}", found.kind()))
    }

    /// Counts what is done.
    pub fn work(&mut self, amount: usize, at: usize) -> Result<(), Error> {
        self.work = self.work.saturating_add(amount);
        match self.work > limits::WORK {
            true => Err(self.error(
                at,
                ErrorKind::Limit,
                "the script computes too much, or texts that are too long",
            )),
            false => Ok(()),
        }
    }

    /// Whether a text matches a regular expression.
    pub fn matches(&mut self, pattern: &Pattern, text: &str, at: usize) -> Result<bool, Error> {
        self.patterns += 1;
        self.matched = self.matched.saturating_add(text.len());
        if self.patterns > limits::PATTERNS || self.matched > limits::MATCHED {
            let message = "the script compares too much text with regular expressions";
            return Err(self.error(at, ErrorKind::Limit, message));
        }
        pattern.matches(text).map_err(|why| {
            let message = format!("the regular expression is not understood: {why}");
            self.error(at, ErrorKind::Pattern, message)
        })
    }

    /// Writes text.
    pub fn write(&mut self, text: &str, at: usize) -> Result<(), Error> {
        if self.output.len() + text.len() > limits::OUTPUT {
            return Err(self.error(at, ErrorKind::Limit, "the script writes more than 16 megabytes"));
        }
        self.output += text;
        Ok(())
    }

    /// A global or local variable.
    pub fn variable(&self, name: &str) -> Option<&Value> {
        self.state.globals().get(name).or_else(|| self.locals.get(name))
    }

    /// Whether there is a placeholder or a variable of this name.
    pub fn is_defined(&self, name: &str) -> bool {
        self.variable(name).is_some() || self.names.value(name).is_some()
    }

    /// A placeholder or a variable.
    pub fn find(&self, name: &str) -> Option<Cow<'_, Value>> {
        let variable = || self.variable(name).map(Cow::Borrowed);
        let written = self.state.written.get(name).map(Cow::Borrowed);
        let asked = || self.asked.contains(name).then_some(Cow::Owned(Value::Flag(false)));
        written.or_else(|| self.names.value(name).map(Cow::Owned)).or_else(variable).or_else(asked)
    }

    /// A placeholder or a variable that must be there.
    pub fn known(&self, name: &str, at: usize) -> Result<Cow<'_, Value>, Error> {
        self.find(name).ok_or_else(|| self.unknown(name, at))
    }

    /// There is no such name.
    pub fn unknown(&self, name: &str, at: usize) -> Error {
        let names = self.names.names();
        let all =
            names.iter().chain(self.state.globals().keys()).chain(self.locals.keys()).map(String::as_str);
        let near = nearest(name, all.chain(KEYWORDS.iter().copied()));
        self.error(at, ErrorKind::UnknownName, format!("unknown name `{name}`")).with_near(near)
    }

    /// The element of a vector: the indexed one, that of the extruder in use, or the first where that is past the end.
    /// What is no vector is its own element.
    pub fn element<'v>(
        &self,
        value: &'v Value,
        index: Option<usize>,
        name: &str,
        at: usize,
    ) -> Result<&'v Value, Error> {
        let Value::List(items) = value else { return Ok(value) };
        let index = index.unwrap_or_else(|| self.names.extruder());
        let item = items.get(index).or(items.first());
        item.ok_or_else(|| self.error(at, ErrorKind::Index, format!("the vector `{name}` is empty")))
    }

    /// Sets a global variable.
    pub fn store_global(&mut self, at: usize, name: &str, value: Value) -> Result<(), Error> {
        match self.state.set_global(name, value, limits::GLOBALS) {
            true => Ok(()),
            false => {
                let message = "the global variables hold more than 16 megabytes";
                Err(self.error(at, ErrorKind::Limit, message))
            }
        }
    }
}
