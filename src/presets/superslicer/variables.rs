//! Names that presets give to scripts themselves, one in each line: `name=value`.

use std::collections::BTreeMap;

use crate::presets::config::Config;
use crate::presets::value::{Scalar, Shape, Type, join_texts, texts, unescaped};

/// Adds them to what scripts know.
pub(super) fn add(config: &mut Config) {
    for key in ["print_custom_variables", "printer_custom_variables"] {
        let Some((_, written)) = config.lists.get(key) else { continue };
        for (name, value) in lines(&unescaped(written)) {
            let scalar = scalar(std::slice::from_ref(&value));
            config.set_raw(&name, &value, Some(Type { scalar, shape: Shape::One }));
        }
        config.forget(key);
    }
    let key = "filament_custom_variables";
    let Some((_, written)) = config.lists.get(key) else { return };
    let filaments: Vec<BTreeMap<String, String>> =
        texts(written).iter().map(|text| lines(text).into_iter().collect()).collect();
    let names: Vec<String> = filaments.iter().flat_map(BTreeMap::keys).cloned().collect();
    for name in names {
        let all: Vec<String> =
            filaments.iter().map(|of| of.get(&name).cloned().unwrap_or_default()).collect();
        let scalar = scalar(&all);
        let value = if scalar == Scalar::Text { join_texts(&all) } else { all.join(",") };
        config.set_raw(&name, &value, Some(Type { scalar, shape: Shape::Each }));
    }
    config.forget(key);
}

fn lines(text: &str) -> Vec<(String, String)> {
    let assigned = text.lines().filter_map(|line| line.split_once('='));
    assigned
        .map(|(name, value)| (name.trim().to_owned(), value.trim().trim_matches('"').to_owned()))
        .collect()
}

/// What values are, by their looks.
fn scalar(values: &[String]) -> Scalar {
    if values.iter().all(|value| value == "true" || value == "false") {
        Scalar::Flag
    } else if values.iter().all(|value| value.parse::<i64>().is_ok()) {
        Scalar::Integer
    } else if values.iter().all(|value| value.parse::<f64>().is_ok()) {
        Scalar::Real
    } else {
        Scalar::Text
    }
}

#[cfg(test)]
mod tests {
    use macros::{Names, Value};

    use super::*;
    use crate::presets::config::Place;

    #[test]
    fn scripts_know_what_presets_name() {
        let mut config = Config::default();
        let place = Place::new("x.ini", 1, "");
        config.set("print_custom_variables", "fast=true\\nrows = 3\\nwho=\"me\"", place.clone());
        config.set("filament_custom_variables", "\"dry=4.5\";\"\"", place);
        add(&mut config);
        let value = |name: &str| config.value(name).unwrap();
        assert_eq!([value("fast"), value("rows")], [Value::Flag(true), Value::Integer(3)]);
        assert_eq!(value("who"), Value::Text("me".into()));
        assert_eq!(value("dry"), Value::List(vec!["4.5".into(), "".into()]));
    }
}
