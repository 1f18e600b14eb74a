//! Profiles and options → settings: later sources win, every value is checked, every problem is reported.

use std::collections::BTreeMap;

use serde::Deserialize;
use toml::{Table, Value};

use super::conflicts;
use super::embedded;
use super::error::{Origin, Problem, ProfileError};
use super::schema;
use super::settings::Settings;
use super::source::{Assignment, Reader};
use super::suggest;
use crate::limits;
use crate::options::{Field, Kind};

/// A setting given on the command line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Override {
    /// Dotted key.
    pub key: String,
    /// As typed: `3`, `15%`, `inner-first`, `[220, 220]`.
    pub value: String,
    /// The option it came by, such as `--set`.
    pub option: &'static str,
}

/// The settings in force, and where each came from.
#[derive(Clone, Debug, PartialEq)]
pub struct Resolved {
    /// Valid, alone and together.
    pub settings: Settings,
    /// Dotted key → where the value in force was written. Holds every key.
    pub origins: BTreeMap<String, Origin>,
    /// What is allowed but unwise.
    pub warnings: Vec<Problem>,
}

/// Resolves the default profile, then `profiles` (names or paths) in turn, then `overrides` in turn.
///
/// # Errors
/// Every problem of every source at once (up to a hundred): unreadable or unknown profiles, circles of `inherits`, unknown
/// keys, values of the wrong type or out of range, and settings that contradict each other.
///
/// # Examples
/// ```
/// use pathwright::profile::resolve;
/// let resolved = resolve(&["petg".into()], &[])?;
/// assert_eq!(resolved.settings.filament.material, "PETG");
/// assert_eq!(resolved.origins["filament.material"].to_string(), "profile petg");
/// # Ok::<(), pathwright::profile::ProfileError>(())
/// ```
pub fn resolve(profiles: &[String], overrides: &[Override]) -> Result<Resolved, ProfileError> {
    let mut reader = Reader::default();
    reader.read(embedded::DEFAULT, "--profile");
    for profile in profiles {
        reader.read(profile, "--profile");
    }
    let Reader { mut assignments, mut problems, notes, .. } = reader;
    assignments.extend(overrides.iter().map(|o| Assignment {
        key: o.key.clone(),
        value: typed_value(&o.key, &o.value),
        origin: Origin::Option(o.option),
    }));

    let mut table = Table::try_from(Settings::default()).expect("settings are a table");
    let mut origins = BTreeMap::new();
    let mut refused = Vec::new();
    for Assignment { key, value, origin } in assignments {
        if problems.len() >= limits::PROFILE_PROBLEMS {
            let message = format!("only the first {} problems are listed", limits::PROFILE_PROBLEMS);
            problems.push(Problem { origin, setting: None, message });
            return Err(ProfileError { problems });
        }
        match check(&key, &value) {
            Ok(()) => {
                if let Some((section, name)) = key.split_once('.')
                    && let Some(Value::Table(section)) = table.get_mut(section)
                {
                    section.insert(name.to_owned(), value);
                }
                origins.insert(key, origin);
            }
            Err(message) => {
                let setting = Some((shortened(&key), shown(&value)));
                problems.push(Problem { origin, setting, message });
                refused.push(key);
            }
        }
    }

    let settings = Settings::deserialize(Value::Table(table)).expect("every value was checked");
    let found = conflicts::find(&settings, &origins);
    // A value that was refused leaves an older one in its place, which must not be blamed for a conflict.
    problems.extend(
        found
            .errors
            .into_iter()
            .filter(|c| !c.keys.iter().any(|k| refused.iter().any(|r| r == k)))
            .map(|c| c.problem),
    );
    if problems.is_empty() {
        let warnings = notes.into_iter().chain(found.warnings).collect();
        Ok(Resolved { settings, origins, warnings })
    } else {
        Err(ProfileError { problems })
    }
}

impl Settings {
    /// The default profile with others on top, each the name of an embedded one or a file (a profile, or another slicer's
    /// configuration).
    ///
    /// # Errors
    /// As [`resolve`].
    pub fn load(profiles: &[&str]) -> Result<Self, ProfileError> {
        let profiles: Vec<String> = profiles.iter().map(|&profile| profile.to_owned()).collect();
        resolve(&profiles, &[]).map(|resolved| resolved.settings)
    }

    /// The same with another value, written as on the command line: `15%`, `0.2`, `inner-first`, `[220, 220]`.
    ///
    /// # Errors
    /// An unknown key, a value of the wrong type or out of range, settings that contradict each other.
    pub fn set(self, key: &str, value: &str) -> Result<Self, ProfileError> {
        self.set_all(&[(key, value)])
    }

    /// The same with other values, of which each may only be allowed with the others.
    ///
    /// # Errors
    /// As [`Settings::set`], every problem at once.
    pub fn set_all(self, values: &[(&str, &str)]) -> Result<Self, ProfileError> {
        let mut table = Table::try_from(self).expect("settings are a table");
        let (mut origins, mut problems) = (BTreeMap::new(), Vec::new());
        let origin = Origin::Option("set");
        for (key, typed) in values {
            let value = typed_value(key, typed);
            match (check(key, &value), key.split_once('.')) {
                (Ok(()), Some((section, name))) => {
                    if let Some(Value::Table(section)) = table.get_mut(section) {
                        section.insert(name.to_owned(), value);
                    }
                    origins.insert((*key).to_owned(), origin.clone());
                }
                (checked, _) => problems.push(Problem {
                    origin: origin.clone(),
                    setting: Some((shortened(key), shown(&value))),
                    message: checked.err().unwrap_or_default(),
                }),
            }
        }
        let settings = Self::deserialize(Value::Table(table)).expect("every value was checked");
        if problems.is_empty() {
            problems
                .extend(conflicts::find(&settings, &origins).errors.into_iter().map(|found| found.problem));
        }
        if problems.is_empty() { Ok(settings) } else { Err(ProfileError { problems }) }
    }
}

/// Reads a value typed on the command line. Quotes may be left out around texts, words and percentages.
fn typed_value(key: &str, typed: &str) -> Value {
    let typed = typed.trim();
    let quoted = typed.starts_with(['"', '\'']);
    let is_text = matches!(schema::field(key), Some(Field { kind: Kind::Text | Kind::Choice(_), .. }));
    let read = || format!("v = {typed}").parse::<Table>().ok()?.remove("v");
    let value = if is_text && !quoted { None } else { read() };
    value.unwrap_or_else(|| Value::String(typed.to_owned()))
}

/// A value as one line of an error message.
fn shown(value: &Value) -> String {
    match value {
        Value::String(text) => shortened(&format!("{text:?}")),
        other => shortened(&other.to_string().replace('\n', " ")),
    }
}

fn shortened(text: &str) -> String {
    const LONGEST: usize = 60;
    if text.chars().count() <= LONGEST {
        return text.to_owned();
    }
    text.chars().take(LONGEST).chain(['…']).collect()
}

/// Is this value allowed for this key? The error says what would be.
pub(super) fn check(key: &str, value: &Value) -> Result<(), String> {
    let Some(field) = schema::field(key) else {
        let near: Vec<String> = suggest::keys(key).into_iter().map(|k| format!("`{k}`")).collect();
        return Err(match near.is_empty() {
            true => "unknown key; `pathwright profiles dump` lists every key".into(),
            false => format!("unknown key; did you mean {}?", near.join(" or ")),
        });
    };
    let expected = || format!("{} is expected", field.expected());
    let fits = match (field.kind, value) {
        (Kind::Number, value) => number(value).is_some_and(|n| in_range(field, n)),
        (Kind::Count, Value::Integer(n)) => in_range(field, *n as f64) && u32::try_from(*n).is_ok(),
        (Kind::Share, value) => share(value).is_some_and(|n| in_range(field, n)),
        (Kind::Flag, value) => value.is_bool(),
        (Kind::Text, Value::String(text))
            if !key.starts_with("gcode.") && text.contains(char::is_control) =>
        {
            return Err("a text of one line is expected".into());
        }
        (Kind::Text, value) => value.is_str(),
        (Kind::Choice(names), Value::String(word)) if !names.contains(&word.as_str()) => {
            let hint = suggest::name(word, names.iter().copied());
            let hint = hint.map(|near| format!("; did you mean `{near}`?")).unwrap_or_default();
            return Err(expected() + &hint);
        }
        (Kind::Choice(_), value) => value.is_str(),
        (Kind::Numbers(count), Value::Array(values)) => {
            values.len() == count && values.iter().all(|v| number(v).is_some_and(|n| in_range(field, n)))
        }
        (Kind::List, Value::Array(values)) => {
            values.iter().all(|v| number(v).is_some_and(|n| in_range(field, n)))
        }
        _ => false,
    };
    if fits { Ok(()) } else { Err(expected()) }
}

fn in_range(field: &Field, number: f64) -> bool {
    number.is_finite() && field.range.is_none_or(|(low, high)| (low..=high).contains(&number))
}

fn number(value: &Value) -> Option<f64> {
    match value {
        Value::Integer(n) => Some(*n as f64),
        Value::Float(n) => Some(*n),
        _ => None,
    }
}

fn share(value: &Value) -> Option<f64> {
    match value {
        Value::String(text) => Some(text.strip_suffix('%')?.trim().parse::<f64>().ok()? / 100.0),
        value => number(value),
    }
}
