//! Cura's definitions of machines and extruders (`.def.json`): settings with values and formulas, inherited by name.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use serde::Deserialize;
use serde_json::value::RawValue;

use super::formula::Value;
use super::said::Said;
use crate::presets::config::Place;
use crate::presets::error::PresetError;
use crate::presets::files::Files;

/// A definition, as it is written.
#[derive(Debug)]
pub(super) struct Definition {
    pub name: String,
    pub inherits: Option<String>,
    pub metadata: serde_json::Map<String, serde_json::Value>,
    pub settings: BTreeMap<String, Said>,
}

#[derive(Deserialize)]
struct Document<'a> {
    name: String,
    inherits: Option<String>,
    #[serde(default)]
    metadata: serde_json::Map<String, serde_json::Value>,
    #[serde(borrow, default)]
    settings: BTreeMap<String, &'a RawValue>,
    #[serde(borrow, default)]
    overrides: BTreeMap<String, &'a RawValue>,
}

/// A setting, or a group of settings.
#[derive(Deserialize)]
struct Node<'a> {
    label: Option<serde_json::Value>,
    default_value: Option<serde_json::Value>,
    value: Option<serde_json::Value>,
    #[serde(borrow, default)]
    children: BTreeMap<String, &'a RawValue>,
}

impl Definition {
    /// Reads a file.
    ///
    /// # Errors
    /// It cannot be read, or is no definition.
    pub fn read(files: &Files, path: &Path) -> Result<Self, PresetError> {
        let file: Arc<str> = path.display().to_string().into();
        let text =
            files.text(path).map_err(|message| PresetError::at(Place::new(file.clone(), 0, ""), message))?;
        Self::parse(file, text.trim_start_matches('\u{feff}'))
    }

    /// Reads the text of a file of that name.
    ///
    /// # Errors
    /// It is no definition.
    pub fn parse(file: Arc<str>, text: &str) -> Result<Self, PresetError> {
        let refuse = |error: serde_json::Error| damaged(&file, &error);
        let document: Document<'_> = serde_json::from_str(text).map_err(refuse)?;
        let mut reader =
            Reader { file: &file, name: &document.name, text, settings: BTreeMap::new(), depth: 0 };
        reader.read(&document.settings).map_err(refuse)?;
        reader.read(&document.overrides).map_err(refuse)?;
        let settings = reader.settings;
        let Document { name, inherits, metadata, .. } = document;
        Ok(Self { name, inherits, metadata, settings })
    }

    /// A text among what is said of the definition itself.
    pub fn about(&self, key: &str) -> Option<&serde_json::Value> {
        self.metadata.get(key)
    }
}

fn damaged(file: &Arc<str>, error: &serde_json::Error) -> PresetError {
    let (line, column) = (error.line(), error.column());
    let whole = error.to_string();
    let what = whole.split(" at line ").next().unwrap_or_default();
    let message =
        format!("column {column}: {what}: this is no definition that could be read; write the file again");
    PresetError::at(Place::new(file.clone(), line, ""), message)
}

/// Groups of settings nest no deeper than this.
const DEEPEST: usize = 32;

struct Reader<'a> {
    file: &'a Arc<str>,
    name: &'a str,
    text: &'a str,
    settings: BTreeMap<String, Said>,
    depth: usize,
}

impl Reader<'_> {
    fn read(&mut self, nodes: &BTreeMap<String, &RawValue>) -> Result<(), serde_json::Error> {
        if self.depth > DEEPEST {
            return Ok(());
        }
        for (key, raw) in nodes {
            let mut node: Node<'_> = serde_json::from_str(raw.get())?;
            // Saved in a project, a setting has its name as its label, and all values as texts.
            let is_saved = node.label.take().is_some_and(|label| label.as_str() == Some(key));
            if let (true, Some(text)) = (is_saved, node.default_value.as_ref().and_then(|v| v.as_str())) {
                let place = Place::new(self.file.clone(), self.line(raw), self.name);
                let formula = node.value.as_ref().and_then(|value| value.as_str());
                let formula = formula.map(|formula| formula.trim_start_matches('=').to_owned());
                self.settings.insert(key.clone(), Said { formula, ..Said::of_text(text, place) });
                self.nested(&node.children)?;
                continue;
            }
            let formula = node.value.as_ref().and_then(|value| value.as_str()).map(str::to_owned);
            let fixed = node.value.as_ref().filter(|value| !value.is_string());
            let plain = fixed.or(node.default_value.as_ref()).map(plain);
            // A value that is no text is a formula that needs no working out.
            let formula = formula.or_else(|| fixed.map(|fixed| self::plain(fixed).written()));
            if plain.is_some() || formula.is_some() {
                let place = Place::new(self.file.clone(), self.line(raw), self.name);
                self.settings.insert(key.clone(), Said { plain, formula, place });
            }
            self.nested(&node.children)?;
        }
        Ok(())
    }

    fn nested(&mut self, nodes: &BTreeMap<String, &RawValue>) -> Result<(), serde_json::Error> {
        self.depth += 1;
        self.read(nodes)?;
        self.depth -= 1;
        Ok(())
    }

    /// The raw value borrows from the text, so that where it stands in memory says where it stands in the file.
    fn line(&self, raw: &RawValue) -> usize {
        let offset = (raw.get().as_ptr() as usize).saturating_sub(self.text.as_ptr() as usize);
        let before = self.text.as_bytes().get(..offset).unwrap_or_default();
        memchr::memchr_iter(b'\n', before).count() + 1
    }
}

fn plain(value: &serde_json::Value) -> Value {
    match value {
        serde_json::Value::Null => Value::Nothing,
        serde_json::Value::Bool(flag) => Value::Flag(*flag),
        serde_json::Value::Number(number) => number.as_f64().map_or(Value::Nothing, Value::Number),
        serde_json::Value::String(text) => Value::Text(text.clone()),
        serde_json::Value::Array(list) => Value::List(list.iter().map(plain).collect()),
        serde_json::Value::Object(_) => Value::Text(value.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_are_found_in_groups_and_know_their_lines() {
        let text = "{\n\"name\": \"M\", \"inherits\": \"base\", \"metadata\": {\"visible\": true},\n\"settings\": {\"a\": {\n\
                    \"children\": {\n\"b\": {\"default_value\": 3, \"value\": \"c * 2\"}}}},\n\
                    \"overrides\": {\"d\": {\"default_value\": [1, 2]}, \"e\": {\"value\": 5}, \"f\": {\"label\": \"x\"}}}";
        let read = Definition::parse("m.def.json".into(), text).unwrap();
        assert_eq!((read.name.as_str(), read.inherits.as_deref()), ("M", Some("base")));
        let b = &read.settings["b"];
        assert_eq!((b.plain.clone(), b.formula.as_deref()), (Some(Value::Number(3.0)), Some("c * 2")));
        assert_eq!(b.place.line, 5);
        assert_eq!(read.settings["d"].plain, Some(Value::List(vec![Value::Number(1.0), Value::Number(2.0)])));
        assert_eq!(read.settings["e"].formula.as_deref(), Some("5"));
        assert!(!read.settings.contains_key("f"));
        let error = Definition::parse("m.def.json".into(), "{\"name\": \"M\",\n}").unwrap_err().to_string();
        assert!(error.starts_with("m.def.json:2: column 1: "), "{error}");
    }
}
