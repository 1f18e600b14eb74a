//! Presets as files: one JSON object of names and values, each with the line it stands on.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use serde_json::Value;
use serde_json::value::RawValue;

use crate::presets::config::Place;
use crate::presets::error::PresetError;
use crate::presets::files::Files;

/// What is written for one key.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Written {
    /// One, or those of a list.
    pub values: Vec<String>,
    /// Whether they stand in brackets.
    pub is_list: bool,
    /// From 1.
    pub line: usize,
}

impl Written {
    /// The first of the values.
    pub fn first(&self) -> &str {
        self.values.first().map_or("", String::as_str)
    }
}

/// A file that holds a JSON object.
#[derive(Clone, Debug)]
pub(super) struct File {
    pub path: Arc<str>,
    pub entries: BTreeMap<String, Written>,
}

impl File {
    /// Reads a file.
    ///
    /// # Errors
    /// It cannot be read, or is no JSON object.
    pub fn read(files: &Files, path: &Path) -> Result<Self, PresetError> {
        let name: Arc<str> = path.display().to_string().into();
        let bytes =
            files.read(path).map_err(|message| PresetError::at(Place::new(name.clone(), 0, ""), message))?;
        Self::parse(name, &bytes)
    }

    /// Reads the bytes of a file of that name.
    ///
    /// # Errors
    /// They are no JSON object.
    pub fn parse(path: Arc<str>, bytes: &[u8]) -> Result<Self, PresetError> {
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        let refuse = |error: serde_json::Error| {
            let (line, column) = (error.line(), error.column());
            let whole = error.to_string();
            let what = whole.split(" at line ").next().unwrap_or_default();
            let message =
                format!("column {column}: {what}: this is no JSON that could be read; write the file again");
            PresetError::at(Place::new(path.clone(), line, ""), message)
        };
        let raw: BTreeMap<String, &RawValue> = serde_json::from_slice(bytes).map_err(refuse)?;
        let ends: Vec<usize> = memchr::memchr_iter(b'\n', bytes).collect();
        let mut entries = BTreeMap::new();
        for (key, raw) in raw {
            // The raw value borrows from the bytes, so that where it stands in memory says where it stands in the file.
            let offset = (raw.get().as_ptr() as usize).saturating_sub(bytes.as_ptr() as usize);
            let line = ends.partition_point(|&end| end < offset) + 1;
            let value: Value = serde_json::from_str(raw.get()).map_err(refuse)?;
            let (values, is_list) = match value {
                Value::Null => continue,
                Value::Array(values) => (values.iter().map(text).collect(), true),
                single => (vec![text(&single)], false),
            };
            entries.insert(key, Written { values, is_list, line });
        }
        Ok(Self { path, entries })
    }

    /// What is written for a key.
    pub fn get(&self, key: &str) -> Option<&Written> {
        self.entries.get(key)
    }

    /// The first value of a key; empty: there is none.
    pub fn text(&self, key: &str) -> &str {
        self.get(key).map_or("", Written::first)
    }
}

fn text(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Bool(flag) => String::from(if *flag { "1" } else { "0" }),
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_strings_numbers_or_lists_and_know_their_lines() {
        let text = "\u{feff}{\n \"a\": \"1\",\n\n \"b\": [\n \"x\", 2\n ],\n \"c\": true, \"d\": null, \"e\": 0.5\n}";
        let file = File::parse("x.json".into(), text.as_bytes()).unwrap();
        let written = |key: &str| file.get(key).map(|w| (w.values.join("|"), w.is_list, w.line));
        assert_eq!(written("a"), Some(("1".into(), false, 2)));
        assert_eq!(written("b"), Some(("x|2".into(), true, 4)));
        assert_eq!(written("c"), Some(("1".into(), false, 7)));
        assert_eq!(written("d"), None);
        assert_eq!(written("e"), Some(("0.5".into(), false, 7)));
    }

    #[test]
    fn damage_is_told_with_line_and_column() {
        let error = File::parse("x.json".into(), b"{\n \"a\": \"1\"\n \"b\": 2\n}").unwrap_err().to_string();
        assert!(error.starts_with("x.json:3: column 2: expected `,` or `}`"), "{error}");
        for damaged in [b"".as_slice(), b"[1]", b"{\"a\": ", b"{\"a\": \"\xff\"}"] {
            assert!(File::parse("x.json".into(), damaged).is_err());
        }
    }
}
