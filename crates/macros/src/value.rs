//! What placeholders and variables hold, and how it is written.

use std::fmt::{self, Display, Formatter};

/// What a placeholder or variable holds.
///
/// `Display` writes it as `{name}` does:
///
/// ```
/// use pathwright_macros::Value;
///
/// assert_eq!(Value::Real(0.2 + 0.1).to_string(), "0.3");
/// assert_eq!(Value::Real(12_500_000.0).to_string(), "1.25e+07");
/// assert_eq!(Value::Flag(true).to_string(), "true");
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Yes or no: `true` in `{name}`, `1` in `[name]`.
    Flag(bool),
    /// A whole number.
    Integer(i64),
    /// A number with decimals, written with six digits as C++ streams do.
    Real(f64),
    /// Percent: `15` in `{name}`, `15%` in `[name]`; see [`Names::whole`](crate::Names::whole).
    Percent(f64),
    /// Text; a choice of several is text as well.
    Text(String),
    /// An optional value that is not set.
    Nil,
    /// A value for each extruder, or of any other vector. A vector within a vector is a point.
    List(Vec<Value>),
}

impl Value {
    /// What kind of value it is, for messages.
    pub(crate) fn kind(&self) -> &'static str {
        match self {
            Self::Flag(_) => "true or false",
            Self::Integer(_) | Self::Real(_) | Self::Percent(_) => "a number",
            Self::Text(_) => "a text",
            Self::Nil => "nil",
            Self::List(_) => "a vector",
        }
    }

    /// Not set: nil, or a number that is none.
    pub(crate) fn is_nil(&self) -> bool {
        matches!(self, Self::Nil) || matches!(self, Self::Real(real) | Self::Percent(real) if real.is_nan())
    }

    /// A number, whole or not.
    pub(crate) fn number(&self) -> Option<f64> {
        match self {
            Self::Integer(integer) => Some(*integer as f64),
            Self::Real(real) | Self::Percent(real) => Some(*real),
            _ => None,
        }
    }

    /// About how many bytes it takes.
    pub(crate) fn size(&self) -> usize {
        size_of::<Self>()
            + match self {
                Self::Text(text) => text.len(),
                Self::List(items) => items.iter().map(Self::size).sum(),
                _ => 0,
            }
    }

    /// How `[name]` writes it: as it stands in a configuration.
    pub(crate) fn bracketed(&self) -> String {
        match self {
            Self::Flag(flag) => u8::from(*flag).to_string(),
            Self::Percent(percent) => format!("{}%", Real(*percent)),
            Self::Text(text) => text.replace('\\', "\\\\").replace('\r', "\\r").replace('\n', "\\n"),
            other => other.element(),
        }
    }

    /// How `[name]` writes an element of a vector: as `bracketed`, texts without escapes.
    pub(crate) fn element(&self) -> String {
        match self {
            Self::Flag(_) | Self::Percent(_) => self.bracketed(),
            Self::List(items) => items.iter().map(Self::to_string).collect::<Vec<_>>().join("x"),
            other => other.to_string(),
        }
    }
}

impl Display for Value {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Flag(flag) => write!(out, "{flag}"),
            Self::Integer(integer) => write!(out, "{integer}"),
            Self::Real(real) | Self::Percent(real) => write!(out, "{}", Real(*real)),
            Self::Text(text) => out.write_str(text),
            Self::Nil => out.write_str("nil"),
            Self::List(items) => {
                let texts: Vec<String> = items.iter().map(Self::to_string).collect();
                write!(out, "[{}]", texts.join(", "))
            }
        }
    }
}

impl From<bool> for Value {
    fn from(flag: bool) -> Self {
        Self::Flag(flag)
    }
}

impl From<i32> for Value {
    fn from(integer: i32) -> Self {
        Self::Integer(integer.into())
    }
}

impl From<i64> for Value {
    fn from(integer: i64) -> Self {
        Self::Integer(integer)
    }
}

impl From<f64> for Value {
    fn from(real: f64) -> Self {
        Self::Real(real)
    }
}

impl From<&str> for Value {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Value {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl<T: Into<Value>> From<Vec<T>> for Value {
    fn from(items: Vec<T>) -> Self {
        Self::List(items.into_iter().map(Into::into).collect())
    }
}

/// A number with six significant digits, as C's `%g` writes it.
struct Real(f64);

impl Display for Real {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        if !self.0.is_finite() {
            return write!(out, "{}", self.0.to_string().to_lowercase());
        }
        // Rounding to six digits decides the power of ten.
        let scientific = format!("{:.5e}", self.0);
        let (digits, power) = scientific.split_once('e').unwrap_or((&scientific, "0"));
        let power: i32 = power.parse().unwrap_or(0);
        let trimmed = |text: &str| match text.contains('.') {
            true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
            false => text.to_owned(),
        };
        if !(-4..6).contains(&power) {
            let sign = if power < 0 { '-' } else { '+' };
            return write!(out, "{}e{sign}{:02}", trimmed(digits), power.unsigned_abs());
        }
        let decimals = (5 - power).unsigned_abs() as usize;
        out.write_str(&trimmed(&format!("{:.decimals$}", self.0)))
    }
}

#[cfg(test)]
mod tests {
    use super::Value;

    #[test]
    fn reals_have_six_digits() {
        // What `printf("%g")` of glibc writes.
        let known = [
            (0.0, "0"),
            (-0.0, "-0"),
            (1.0, "1"),
            (0.1, "0.1"),
            (100_000.0, "100000"),
            (999_999.4, "999999"),
            (999_999.5, "1e+06"),
            (1_000_000.0, "1e+06"),
            (123_456_789.0, "1.23457e+08"),
            (0.0001, "0.0001"),
            (0.000_099_999_99, "0.0001"),
            (0.000_012_5, "1.25e-05"),
            (1e100, "1e+100"),
            (-2.5, "-2.5"),
            (1.0 / 3.0, "0.333333"),
            (20.345_678, "20.3457"),
        ];
        for (real, text) in known {
            assert_eq!(Value::Real(real).to_string(), text);
        }
    }
}
