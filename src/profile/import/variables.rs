//! What scripts of others may name: every value of their configuration.

use toml::Value;

use super::config::Config;
use super::script::unescaped;

/// Names, values and lines, in the order of the names.
pub(super) fn all(config: &Config) -> Vec<(String, Value, usize)> {
    let is_name = |name: &str| name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    let entries = config.entries.iter().filter(|(name, _)| is_name(name));
    entries.map(|(name, entry)| (name.clone(), value(&entry.value), entry.line)).collect()
}

/// A value by what it looks like: numbers between commas and texts between semicolons are vectors.
fn value(written: &str) -> Value {
    let text = written.trim();
    if text.starts_with('"') {
        let texts = quoted(text);
        return match texts.as_slice() {
            [only] => Value::String(only.clone()),
            _ => Value::Array(texts.into_iter().map(Value::String).collect()),
        };
    }
    if text.contains(',')
        && let Some(values) = text.split(',').map(|part| scalar(part.trim())).collect::<Option<Vec<_>>>()
    {
        return Value::Array(values);
    }
    scalar(text).unwrap_or_else(|| Value::String(unescaped(text)))
}

/// A number, a point or a percentage.
fn scalar(text: &str) -> Option<Value> {
    if let Ok(whole) = text.parse::<i64>() {
        return Some(Value::Integer(whole));
    }
    if let Ok(real) = text.parse::<f64>()
        && real.is_finite()
    {
        return Some(Value::Float(real));
    }
    if text == "nil" || text.strip_suffix('%').is_some_and(|number| number.parse::<f64>().is_ok()) {
        return Some(Value::String(text.into()));
    }
    let (x, y) = text.split_once('x')?;
    Some(Value::Array(vec![Value::Float(x.parse().ok()?), Value::Float(y.parse().ok()?)]))
}

/// Texts in quotes, between semicolons.
fn quoted(text: &str) -> Vec<String> {
    let (mut texts, mut rest) = (Vec::new(), text);
    while rest.starts_with('"') {
        texts.push(unescaped(rest));
        let mut escaped = false;
        let end = rest[1..].find(|c| {
            let ends = c == '"' && !escaped;
            escaped = c == '\\' && !escaped;
            ends
        });
        rest = end.map_or("", |end| rest[end + 2..].trim_start_matches([';', ' ']));
    }
    texts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_read_by_what_they_look_like() {
        let known = [
            ("0.4", "0.4"),
            ("210", "210"),
            ("0.4,0.6", "[0.4, 0.6]"),
            ("15%", "\"15%\""),
            ("0x0,250x210", "[[0.0, 0.0], [250.0, 210.0]]"),
            ("\"PLA\";\"a \\\"b\\\"\"", "[\"PLA\", 'a \"b\"']"),
            ("grid", "\"grid\""),
            ("line\\nline", "\"line\\nline\""),
        ];
        for (written, read) in known {
            assert_eq!(value(written).to_string(), read, "{written}");
        }
    }
}
