//! What definitions and containers say of a setting: a value, a formula.

use super::formula::Value;
use crate::presets::config::Place;

/// What is said of a setting.
#[derive(Clone, Debug)]
pub(super) struct Said {
    /// It counts where there is no formula.
    pub plain: Option<Value>,
    pub formula: Option<String>,
    pub place: Place,
}

impl Said {
    /// A value as it is written, or a formula after `=`.
    pub fn of_text(written: &str, place: Place) -> Self {
        if let Some(formula) = written.strip_prefix('=') {
            return Self { plain: None, formula: Some(formula.trim().to_owned()), place };
        }
        let plain = match written {
            "True" | "true" | "yes" => Value::Flag(true),
            "False" | "false" | "no" => Value::Flag(false),
            _ => match written.parse::<f64>() {
                Ok(number) if number.is_finite() => Value::Number(number),
                _ => Value::Text(written.to_owned()),
            },
        };
        Self { plain: Some(plain), formula: None, place }
    }

    /// Goes on with another line, after some empty ones: of a text it is a line, of a formula there are none.
    pub fn go_on(&mut self, empty: usize, line: &str) {
        if let Some(formula) = &mut self.formula {
            formula.push(' ');
            formula.push_str(line);
        } else {
            let begun = self.plain.take().map(|value| value.written()).unwrap_or_default();
            self.plain = Some(Value::Text(format!("{begun}{}{line}", "\n".repeat(empty + 1))));
        }
    }
}
