//! Values of a configuration as its scripts and conditions see them.

use macros::{Names, Value};

use super::config::{Config, Raw};
use super::keys;
use super::value::{Scalar, Shape, Type, for_all, point, texts, unescaped};

/// What a setting of PrusaSlicer is to scripts where no preset says it, by a printer with so many extruders; `None`: it has no such
/// setting.
pub fn built_in_value(name: &str, extruders: usize) -> Option<Value> {
    let key = keys::find(name)?;
    let value = for_all(key.kind, key.default, extruders, key.default);
    Some(script_value(&Raw { value, kind: Some(key.kind) }))
}

/// What a value as written is to scripts.
pub fn script_value(raw: &Raw) -> Value {
    let text = raw.value.as_str();
    let Some(Type { scalar, shape }) = raw.kind else { return unknown(text) };
    match (shape, scalar) {
        (Shape::One, Scalar::Text) => Value::Text(unescaped(text)),
        (Shape::One, scalar) => single(scalar, text),
        (Shape::Each, Scalar::Text) if texts(text).is_empty() => {
            Value::List(vec![Value::Text(String::new())])
        }
        (_, Scalar::Text) => {
            Value::List(texts(text).into_iter().map(|t| Value::Text(t.into_owned())).collect())
        }
        (_, _) if text.is_empty() => Value::List(Vec::new()),
        (_, scalar) => Value::List(text.split(',').map(|text| single(scalar, text)).collect()),
    }
}

fn single(scalar: Scalar, text: &str) -> Value {
    let text = text.trim();
    let percent = || text.strip_suffix('%').and_then(number).map(Value::Percent);
    let read = match scalar {
        _ if text == "nil" => Some(Value::Nil),
        Scalar::Flag => match text {
            "1" | "true" => Some(Value::Flag(true)),
            "0" | "false" => Some(Value::Flag(false)),
            _ => None,
        },
        Scalar::Integer => text.parse().ok().map(Value::Integer),
        Scalar::Real => number(text).map(Value::Real),
        Scalar::Percent | Scalar::RealOrPercent => percent().or_else(|| number(text).map(Value::Real)),
        Scalar::Point => point(text).map(|point| Value::List(point.map(Value::Real).to_vec())),
        Scalar::Text | Scalar::Choice => None,
    };
    read.unwrap_or_else(|| Value::Text(text.to_owned()))
}

/// What nobody has described is what it looks like.
fn unknown(text: &str) -> Value {
    let text = text.trim();
    if let Ok(integer) = text.parse() {
        return Value::Integer(integer);
    }
    number(text).map_or_else(|| Value::Text(unescaped(text)), Value::Real)
}

fn number(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|number: &f64| number.is_finite())
}

/// The complete configuration, under the slicer's own names.
impl Names for Config {
    fn value(&self, name: &str) -> Option<Value> {
        self.raw.get(name).map(script_value)
    }

    fn names(&self) -> Vec<String> {
        self.raw.keys().cloned().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::presets::key_type;

    #[test]
    fn values_are_what_their_type_says() {
        let value = |key: &str, text: &str| script_value(&Raw { value: text.into(), kind: key_type(key) });
        assert_eq!(value("nozzle_diameter", "0.4,0.6"), Value::List(vec![0.4.into(), 0.6.into()]));
        assert_eq!(value("printer_notes", "a\\nb"), Value::Text("a\nb".into()));
        assert_eq!(value("filament_type", "PLA;PETG"), Value::List(vec!["PLA".into(), "PETG".into()]));
        assert_eq!(value("bed_shape", "0x0"), Value::List(vec![Value::List(vec![0.0.into(), 0.0.into()])]));
        assert_eq!(value("fill_density", "15%"), Value::Percent(15.0));
        assert_eq!(value("filament_wipe", "nil"), Value::List(vec![Value::Nil]));
        assert_eq!(value("spiral_vase", "0"), Value::Flag(false));
        assert_eq!(value("what", "7"), Value::Integer(7), "not known");
    }
}
