//! A configuration of another slicer: every key with its value, where it was written, and whose words it uses.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

use super::keys;
use super::value::{self, Type};

/// Whose words a configuration was written in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Dialect {
    /// PrusaSlicer, and Slic3r before it.
    #[default]
    Prusa,
    /// SuperSlicer, whose words become PrusaSlicer's.
    Super,
    /// OrcaSlicer, Bambu Studio, Creality Print.
    Orca,
    /// Cura.
    Cura,
}

impl Dialect {
    /// The slicer's name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Prusa => "PrusaSlicer",
            Self::Super => "SuperSlicer",
            Self::Orca => "OrcaSlicer",
            Self::Cura => "Cura",
        }
    }
}

/// Where a value was written.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Place {
    /// Path of the file as it was named; for what a slicer has built in, the slicer's name.
    pub file: Arc<str>,
    /// From 1; 0: not in a file, or in one that has no lines.
    pub line: usize,
    /// The preset in that file; empty: the file is all there is.
    pub preset: Arc<str>,
}

impl Place {
    /// A line of a preset in a file.
    pub fn new(file: impl Into<Arc<str>>, line: usize, preset: impl Into<Arc<str>>) -> Self {
        Self { file: file.into(), line, preset: preset.into() }
    }

    /// What a slicer takes where no preset says anything.
    pub fn built_in(dialect: Dialect) -> Self {
        Self::new(dialect.name(), 0, "")
    }

    /// Whether this is [`Place::built_in`].
    pub fn is_built_in(&self) -> bool {
        self.line == 0 && self.preset.is_empty()
    }
}

impl fmt::Display for Place {
    /// `file:line`, then the preset.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { file, line, preset } = self;
        match (line, preset.is_empty()) {
            (0, true) => write!(f, "built into {file}"),
            (0, false) => write!(f, "{file} [{preset}]"),
            (_, true) => write!(f, "{file}:{line}"),
            (_, false) => write!(f, "{file}:{line} [{preset}]"),
        }
    }
}

/// One value, and where it was written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    /// As PrusaSlicer writes it: `,` between numbers, `;` between texts, `nil`, `%`.
    pub value: String,
    /// Where it was written.
    pub place: Place,
}

/// One value under the name that the slicer's own scripts know it by.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Raw {
    /// Of all extruders, written as in [`Entry`].
    pub value: String,
    /// What it is; `None`: not known, to be seen from the value.
    pub kind: Option<Type>,
}

/// Every key of a configuration.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Config {
    /// PrusaSlicer's (or SuperSlicer's) keys, whatever the slicer, as they hold for the first extruder.
    pub entries: BTreeMap<String, Entry>,
    /// The same as they were given, of all extruders, and what they are.
    pub(super) lists: BTreeMap<String, (Option<Type>, String)>,
    /// The complete configuration in the slicer's own keys, as its scripts see it.
    pub raw: BTreeMap<String, Raw>,
    /// Whose words the entries and the scripts among them use.
    pub dialect: Dialect,
    /// Whether it is what was saved with a single object, or a part of one.
    pub of_object: bool,
}

impl Config {
    /// Adds a value in PrusaSlicer's words, of which the first extruder's is kept.
    pub fn set(&mut self, key: &str, value: &str, place: Place) {
        self.set_known(key, value, keys::key_type(key), place);
    }

    /// The same where it is known what the value is.
    pub(super) fn set_known(&mut self, key: &str, value: &str, kind: Option<Type>, place: Place) {
        self.lists.insert(key.to_owned(), (kind, value.to_owned()));
        let value = value::of_extruder(kind, value, 0).into_owned();
        self.entries.insert(key.to_owned(), Entry { value, place });
    }

    /// Adds a value as the slicer's own scripts call it.
    pub fn set_raw(&mut self, name: &str, value: &str, kind: Option<Type>) {
        self.raw.insert(name.to_owned(), Raw { value: value.to_owned(), kind });
    }

    /// How many extruders the printer has: as many as it has nozzles.
    pub fn extruders(&self) -> usize {
        let nozzles = self.lists.get("nozzle_diameter").map(|(_, value)| value.split(',').count());
        nozzles.unwrap_or(1).max(1)
    }

    /// The same with the values of an extruder, counted from 0, in the entries.
    #[must_use]
    pub fn of_extruder(&self, extruder: usize) -> Self {
        let mut own = self.clone();
        for (key, (kind, value)) in &self.lists {
            if let Some(entry) = own.entries.get_mut(key) {
                entry.value = value::of_extruder(*kind, value, extruder).into_owned();
            }
        }
        own
    }

    /// The numbers of a list that is not one for each extruder.
    pub fn list(&self, key: &str) -> Option<Vec<f64>> {
        self.text(key)?.split(',').map(|number| number.trim().parse().ok()).collect()
    }

    /// The points of a list, mm.
    pub fn points(&self, key: &str) -> Option<Vec<[f64; 2]>> {
        self.text(key)?.split(',').map(value::point).collect()
    }

    /// A value that is there and not `nil`, as written.
    pub fn text(&self, key: &str) -> Option<&str> {
        let value = self.entries.get(key)?.value.trim();
        (value != "nil" && !value.is_empty()).then_some(value)
    }

    /// The first extruder's share of a value.
    pub fn first(&self, key: &str) -> Option<&str> {
        self.text(key).map(|text| text.split(',').next().unwrap_or_default().trim())
    }

    /// A finite number.
    pub fn number(&self, key: &str) -> Option<f64> {
        self.first(key)?.parse().ok().filter(|n: &f64| n.is_finite())
    }

    /// A number, or a percentage of another.
    pub fn number_of(&self, key: &str, whole: Option<f64>) -> Option<f64> {
        match self.first(key)?.strip_suffix('%') {
            Some(percent) => Some(percent.trim().parse::<f64>().ok()? / 100.0 * whole?),
            None => self.number(key),
        }
    }

    /// A script, or the first of several: without quotes and escapes, its lines ended; empty where there is no line.
    pub fn script(&self, key: &str) -> String {
        let written = self.text(key).unwrap_or_default();
        let mut text = match written.starts_with('"') {
            true => value::texts(written).into_iter().next().unwrap_or_default().into_owned(),
            false => value::unescaped(written),
        };
        text.retain(|c| c != '\r');
        if !text.is_empty() && !text.ends_with('\n') {
            text.push('\n');
        }
        text
    }

    /// Whether something is on.
    pub fn flag(&self, key: &str) -> Option<bool> {
        match self.first(key)? {
            "1" | "true" | "enabled" => Some(true),
            "0" | "false" | "disabled" | "none" | "nowhere" => Some(false),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentages_are_of_something_and_nil_is_nothing() {
        let mut config = Config::default();
        for (key, value) in [("a", "50%"), ("b", "nil"), ("c", "1500,1250"), ("filament_wipe", "nil,1")] {
            config.set(key, value, Place::new("x.ini", 1, ""));
        }
        assert_eq!(config.number_of("a", Some(30.0)), Some(15.0));
        assert_eq!((config.number_of("a", None), config.text("b")), (None, None));
        assert_eq!(config.number("c"), Some(1500.0), "the first of several");
        assert_eq!(config.text("filament_wipe"), None, "the first extruder has none of its own");
    }

    #[test]
    fn scripts_have_no_quotes_and_escapes_and_end_with_a_line() {
        let mut config = Config::default();
        let scripts = [
            ("start_gcode", "G28\\n; a \\\\ b", "G28\n; a \\ b\n"),
            ("start_filament_gcode", "\"M900 K1\\nM2\";\"M900 K2\"", "M900 K1\nM2\n"),
            ("end_gcode", "\"\"", ""),
        ];
        for (key, written, script) in scripts {
            config.set(key, written, Place::new("x.ini", 1, ""));
            assert_eq!(config.script(key), script);
        }
    }

    #[test]
    fn a_place_says_what_there_is_to_say() {
        let said = [
            (Place::new("a.ini", 7, "print:A"), "a.ini:7 [print:A]"),
            (Place::new("a.ini", 7, ""), "a.ini:7"),
            (Place::built_in(Dialect::Prusa), "built into PrusaSlicer"),
        ];
        for (place, text) in said {
            assert_eq!(place.to_string(), text);
        }
    }
}
