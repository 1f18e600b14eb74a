//! Settings in force as a configuration in PrusaSlicer's words.

use std::collections::BTreeSet;

use super::formula::Value;
use super::stack::Stack;
use super::table;
use crate::presets::config::{Config, Dialect, Place};
use crate::presets::keys;
use crate::presets::value::{Scalar, Shape, Type, escaped, join_texts, unescaped};

/// The configuration that settings amount to.
pub(super) fn config(stack: &Stack) -> Config {
    let mut config = Config { dialect: Dialect::Cura, ..Config::default() };
    let mut told = BTreeSet::new();
    for (theirs, key, rule) in table::TABLE {
        if stack.place(theirs).is_none() || stack.value(theirs).is_err() {
            continue;
        }
        told.insert(*theirs);
        if let Some(value) = table::said(rule, theirs, stack) {
            let is_one_of_several = matches!(rule, table::Rule::Script)
                && keys::key_type(key).is_some_and(|kind| kind.shape == Shape::Each);
            let value = if is_one_of_several { join_texts(&[unescaped(&value)]) } else { value };
            let place = stack.own_place(theirs).cloned().unwrap_or_else(|| Place::built_in(Dialect::Cura));
            config.set(key, &value, place);
        }
    }
    for key in stack.keys() {
        match stack.value(key) {
            Ok(value) => config.set_raw(key, &raw(&value), Some(kind(&value))),
            Err(reason) => {
                // What is not worked out is told by its name, with the formula.
                if let (Some(place), Some(formula)) = (stack.own_place(key), stack.formula(key)) {
                    config.set(key, &format!("= {formula} ({reason})"), place.clone());
                }
                continue;
            }
        }
        let is_new = !told.contains(key) && !table::IDLE.contains(&key);
        if let (true, Some(place)) = (is_new, stack.own_place(key)) {
            let value = stack.text(key);
            if !matches!(value.as_str(), "" | "False" | "0" | "none") && keys::find(key).is_none() {
                config.set(key, &escaped(&value), place.clone());
            }
        }
    }
    config
}

fn raw(value: &Value) -> String {
    match value {
        Value::Text(text) => escaped(text),
        Value::List(list) => join_texts(&list.iter().map(Value::written).collect::<Vec<_>>()),
        other => other.written(),
    }
}

fn kind(value: &Value) -> Type {
    let (scalar, shape) = match value {
        Value::Number(number) if number.fract() == 0.0 => (Scalar::Integer, Shape::One),
        Value::Number(_) => (Scalar::Real, Shape::One),
        // Scripts show `True` and `False`.
        Value::Flag(_) | Value::Nothing | Value::Text(_) => (Scalar::Text, Shape::One),
        Value::List(_) => (Scalar::Text, Shape::List),
    };
    Type { scalar, shape }
}
