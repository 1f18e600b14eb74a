//! Values as they are written, and whether they are allowed.

use toml::{Table, Value};

use super::schema;
use super::suggest;
use super::tools;
use crate::near;
use crate::options::{Field, Kind};

/// Reads a value typed on the command line. Quotes may be left out around texts, words and percentages.
pub(super) fn typed_value(key: &str, typed: &str) -> Value {
    let typed = typed.trim();
    let quoted = typed.starts_with(['"', '\'']);
    let of_tool = tools::split(key);
    let key = of_tool.as_ref().map_or(key, |(_, key)| key);
    let is_text = matches!(schema::field(key), Some(Field { kind: Kind::Text | Kind::Choice(_), .. }));
    let read = || format!("v = {typed}").parse::<Table>().ok()?.remove("v");
    let value = if is_text && !quoted { None } else { read() };
    value.unwrap_or_else(|| Value::String(typed.to_owned()))
}

/// A value as one line of an error message.
pub(super) fn shown(value: &Value) -> String {
    match value {
        Value::String(text) => shortened(&format!("{text:?}")),
        other => shortened(&other.to_string().replace('\n', " ")),
    }
}

pub(super) fn shortened(text: &str) -> String {
    const LONGEST: usize = 60;
    if text.chars().count() <= LONGEST {
        return text.to_owned();
    }
    text.chars().take(LONGEST).chain(['…']).collect()
}

/// Is this value allowed for this key? The error says what would be.
pub(super) fn check(key: &str, value: &Value) -> Result<(), String> {
    if let Some(name) = key.strip_prefix(VARIABLES) {
        return check_variable(name, value);
    }
    if key == "tools" {
        // A list of tools comes key by key; an empty one takes away those of the profiles before.
        let empty = value.as_array().is_some_and(Vec::is_empty);
        return if empty { Ok(()) } else { Err("tables are expected, each under `[[tools]]`".into()) };
    }
    if tools::number(key).is_some() && value.as_table().is_some_and(Table::is_empty) {
        return Ok(());
    }
    if key.starts_with(tools::TOOLS) {
        let (_, own) = tools::split(key)?;
        check(&own, value)?;
        return match tools::may_differ(&own) {
            true => Ok(()),
            false => Err(format!("it is the same for all tools, which may differ in {}", tools::may_have())),
        };
    }
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
        (Kind::Text, Value::String(text)) if !is_script(key) && text.contains(char::is_control) => {
            return Err("a text of one line is expected".into());
        }
        (Kind::Text, value) => value.is_str(),
        (Kind::Choice(names), Value::String(word)) if !names.contains(&word.as_str()) => {
            let hint = near::name(word, names.iter().copied());
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

/// Whether a text may have several lines.
fn is_script(key: &str) -> bool {
    key.starts_with("gcode.") || key == "tool_change.script"
}

/// What the keys of variables begin with.
pub(super) const VARIABLES: &str = "variables.";

/// Variables are called as names in scripts may be, and hold what scripts can use.
fn check_variable(name: &str, value: &Value) -> Result<(), String> {
    let mut letters = name.chars();
    let begins = letters.next().is_some_and(|c| c.is_ascii_alphabetic() || c == '_');
    if !begins || !letters.all(|c| c.is_ascii_alphanumeric() || c == '_') {
        return Err("a name of letters, digits and underscores is expected".into());
    }
    let is_scalar = |value: &Value| !matches!(value, Value::Table(_) | Value::Array(_) | Value::Datetime(_));
    let is_flat = |value: &Value| value.as_array().is_some_and(|values| values.iter().all(is_scalar));
    let fits = is_scalar(value)
        || value
            .as_array()
            .is_some_and(|values| values.iter().all(|value| is_scalar(value) || is_flat(value)));
    if fits { Ok(()) } else { Err("a number, text, true, false, or a list of them is expected".into()) }
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

/// Scripts as multi-line strings, which `toml` writes on one line.
pub(super) fn toml_text(value: &Value) -> String {
    match value {
        Value::String(text) if text.contains('\n') && !text.contains("'''") && !text.contains('\r') => {
            format!("'''\n{text}'''")
        }
        value => value.to_string(),
    }
}
