//! Values as PrusaSlicer writes them: lists of numbers and of texts, quotes and escapes, one way to write each.

use std::borrow::Cow;

/// What a single value is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scalar {
    /// `0` or `1`.
    Flag,
    /// A whole number.
    Integer,
    /// A number.
    Real,
    /// `15%`.
    Percent,
    /// A number, or a percentage of something.
    RealOrPercent,
    /// Any text.
    Text,
    /// `120x80`.
    Point,
    /// One of some words.
    Choice,
}

/// How many values a key has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// A single one.
    One,
    /// One for each extruder, or for the filament in it.
    Each,
    /// A list of its own length.
    List,
}

/// What the value of a key is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Type {
    /// What each of its values is.
    pub scalar: Scalar,
    /// How many it has.
    pub shape: Shape,
}

/// The part of a value that is of an extruder, counted from 0, or of the first where the list is shorter; values that are not of
/// extruders are left as they are.
pub(super) fn of_extruder(kind: Option<Type>, value: &str, extruder: usize) -> Cow<'_, str> {
    match kind {
        Some(Type { shape: Shape::Each, scalar: Scalar::Text }) => {
            let all = texts(value);
            match all.get(extruder).or(all.first()) {
                Some(own) => Cow::Owned(join_texts(std::slice::from_ref(own))),
                None => Cow::Borrowed(value),
            }
        }
        Some(Type { shape: Shape::Each, .. }) => {
            let own = value.split(',').nth(extruder).or(value.split(',').next());
            Cow::Borrowed(own.unwrap_or(value).trim())
        }
        _ => Cow::Borrowed(value),
    }
}

/// A value as PrusaSlicer itself would write it, whoever wrote it: `0.20` is `0.2`, a percentage has its sign. What is not of
/// the type is left as it is.
pub(super) fn written_alike(kind: Type, value: &str) -> String {
    match (kind.shape, kind.scalar) {
        (Shape::One, Scalar::Text) => escaped(&unescaped(value)),
        (_, Scalar::Text) => join_texts(&texts(value)),
        (Shape::One, scalar) => single(scalar, value),
        (_, scalar) if !value.trim().is_empty() => {
            value.split(',').map(|value| single(scalar, value)).collect::<Vec<_>>().join(",")
        }
        _ => String::new(),
    }
}

/// A value with as many as there are extruders, where it is one for each.
pub(super) fn for_all(kind: Type, value: &str, extruders: usize, default: &str) -> String {
    match kind.shape {
        Shape::Each => for_extruders(kind, value, extruders, default),
        Shape::One | Shape::List => value.to_owned(),
    }
}

/// Of a list that is one for each extruder, as many as there are extruders: the first again where there are too few.
pub(super) fn for_extruders(kind: Type, value: &str, count: usize, default: &str) -> String {
    fn filled<T: Clone>(mut values: Vec<T>, count: usize, default: T) -> Vec<T> {
        let first = values.first().cloned().unwrap_or(default);
        values.resize(count, first);
        values
    }
    match kind.scalar {
        Scalar::Text => {
            let default = texts(default).into_iter().next().unwrap_or_default();
            join_texts(&filled(texts(value), count, default))
        }
        _ => {
            let values = value.split(',').filter(|value| !value.is_empty()).collect();
            filled(values, count, default).join(",")
        }
    }
}

fn single(scalar: Scalar, value: &str) -> String {
    let value = value.trim();
    let number = |text: &str| text.parse::<f64>().ok().filter(|n| n.is_finite()).map(short);
    let percent = || number(value.strip_suffix('%')?.trim()).map(|number| number + "%");
    let written = match scalar {
        Scalar::Flag => match value {
            "true" => Some("1".into()),
            "false" => Some("0".into()),
            _ => None,
        },
        Scalar::Integer | Scalar::Real => number(value),
        Scalar::Percent => percent().or_else(|| number(value).map(|number| number + "%")),
        Scalar::RealOrPercent => percent().or_else(|| number(value)),
        Scalar::Point => point(value).map(|[x, y]| short(x) + "x" + &short(y)),
        Scalar::Text | Scalar::Choice => None,
    };
    written.unwrap_or_else(|| value.to_owned())
}

/// A point, `0x250`, mm. As the slicers read it: what follows a number is passed over, and a Y that is missing is 0, so that a
/// vendor's `235-0` is a corner.
pub(crate) fn point(text: &str) -> Option<[f64; 2]> {
    let (x, y) = text.trim().split_once('x').unwrap_or((text.trim(), "0"));
    Some([number_before(x)?, number_before(y)?])
}

/// The number that a text begins with.
fn number_before(text: &str) -> Option<f64> {
    let text = text.trim();
    let is_inside =
        |(at, c): &(usize, char)| c.is_ascii_digit() || *c == '.' || *at == 0 && matches!(c, '-' | '+');
    let length = text.char_indices().take_while(is_inside).count();
    text.parse().or_else(|_| text[..length].parse()).ok().filter(|n: &f64| n.is_finite())
}

/// A number as C++ streams write it, and scripts do; 0 has no sign.
fn short(number: f64) -> String {
    macros::Value::Real(number + 0.0).to_string()
}

/// The texts of a list: separated by `;`, with or without quotes.
pub(super) fn texts(written: &str) -> Vec<Cow<'_, str>> {
    let mut out = Vec::new();
    let mut rest = written.trim();
    if rest.is_empty() {
        return out;
    }
    loop {
        rest = rest.trim_start();
        let quoted = rest.starts_with('"');
        let inside = &rest[usize::from(quoted)..];
        let end = end_of(inside, if quoted { '"' } else { ';' });
        let text = if quoted { &inside[..end] } else { inside[..end].trim_end() };
        out.push(if text.contains('\\') { Cow::Owned(unescaped(text)) } else { Cow::Borrowed(text) });
        let after = inside.get(end + usize::from(quoted)..).unwrap_or_default().trim_start();
        match after.find(';') {
            Some(at) => rest = &after[at + 1..],
            None => return out,
        }
    }
}

/// Where a character stands that no backslash precedes, or the end.
fn end_of(text: &str, end: char) -> usize {
    let mut is_escaped = false;
    for (at, c) in text.char_indices() {
        if !is_escaped && c == end {
            return at;
        }
        is_escaped = !is_escaped && c == '\\';
    }
    text.len()
}

/// Texts as a list, with quotes where they are needed.
pub(super) fn join_texts<T: AsRef<str>>(texts: &[T]) -> String {
    let quoted = |text: &T| {
        let text = text.as_ref();
        let special = |c: char| matches!(c, ' ' | ';' | '\t' | '\\' | '"' | '\r' | '\n');
        match text.contains(special) || (texts.len() == 1 && text.is_empty()) {
            true => format!("\"{}\"", escaped(text).replace('"', "\\\"")),
            false => text.to_owned(),
        }
    };
    texts.iter().map(quoted).collect::<Vec<_>>().join(";")
}

/// A text as it stands in a configuration, on one line.
pub(super) fn escaped(text: &str) -> String {
    text.replace('\\', "\\\\").replace('\r', "\\r").replace('\n', "\\n")
}

/// A text with its escapes undone.
pub(super) fn unescaped(written: &str) -> String {
    let mut out = String::with_capacity(written.len());
    let mut chars = written.chars();
    while let Some(c) = chars.next() {
        match c {
            '\\' => match chars.next() {
                Some('n') => out.push('\n'),
                Some('r') => out.push('\r'),
                Some(other) => out.push(other),
                None => out.push('\\'),
            },
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_read_and_written_back() {
        for (written, read) in [
            ("\"a b\";\"c\\nd\"", vec!["a b", "c\nd"]),
            ("PLA;PETG", vec!["PLA", "PETG"]),
            ("\"\"", vec![""]),
            (";;", vec!["", "", ""]),
            ("\"x \\\"y\\\" ; \\\\z\"", vec!["x \"y\" ; \\z"]),
        ] {
            let texts = texts(written);
            assert_eq!(texts, read, "{written}");
            let again = super::texts(&join_texts(&texts)).join("|");
            assert_eq!(again, read.join("|"), "{written}");
        }
        assert_eq!(texts(" a b ; c "), ["a b", "c"]);
        assert_eq!(texts("  "), Vec::<String>::new());
        assert_eq!(texts("\"never closed"), ["never closed"]);
    }

    #[test]
    fn numbers_are_written_one_way() {
        for (number, written) in [
            (0.2, "0.2"),
            (-0.0, "0"),
            (1e6, "1e+06"),
            (123_456.7, "123457"),
            (0.000_01, "1e-05"),
            (500.0, "500"),
            (2.0 / 3.0, "0.666667"),
        ] {
            assert_eq!(short(number), written);
        }
    }

    #[test]
    fn values_are_written_as_their_type_is() {
        let list = |scalar| Type { scalar, shape: Shape::List };
        assert_eq!(written_alike(list(Scalar::Percent), "0, 70%"), "0%,70%");
        assert_eq!(written_alike(list(Scalar::Point), "0x0,250.0x-0.50"), "0x0,250x-0.5");
        assert_eq!(written_alike(list(Scalar::Real), "nil,0.20"), "nil,0.2");
        assert_eq!(written_alike(list(Scalar::Text), "Generic PLA"), "\"Generic PLA\"");
        let text = Type { scalar: Scalar::Text, shape: Shape::One };
        assert_eq!(written_alike(text, "P \\\"x\\\"\\nG28"), "P \"x\"\\nG28");
    }

    #[test]
    fn every_extruder_has_its_value() {
        let each = |scalar| Type { scalar, shape: Shape::Each };
        assert_eq!(for_extruders(each(Scalar::Real), "0.8", 3, "2"), "0.8,0.8,0.8");
        assert_eq!(for_extruders(each(Scalar::Real), "1,2,3", 2, "2"), "1,2");
        assert_eq!(for_extruders(each(Scalar::Text), "", 1, "\"\""), "\"\"");
        assert_eq!(for_extruders(each(Scalar::Text), "\"\"", 2, "\"\""), ";");
    }
}
