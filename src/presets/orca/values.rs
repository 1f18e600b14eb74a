//! All that is written of a configuration in the words of OrcaSlicer and its kin, and what is built in where nothing is.

use std::cell::RefCell;
use std::collections::BTreeMap;

use super::json::Written;
use super::legacy::{ABSOLUTE, RENAMED, REWORDED};
use crate::presets::config::Place;
use crate::presets::value::{Scalar, Shape, Type, texts, unescaped};

/// What the values of a key are, and what is built in for it; `None`: there is no such key.
type BuiltIn = fn(&str) -> Option<(Type, &'static str)>;

/// What is written, by key; of a chain of presets the last one's word.
#[derive(Debug)]
pub(super) struct Values {
    /// What the values of a key are, and what is built in for it.
    built_in: BuiltIn,
    written: BTreeMap<String, (Written, Place)>,
    /// Where the last of the keys was written that a rule asked for.
    asked: RefCell<Option<Place>>,
}

impl Values {
    /// Nothing is written yet.
    pub fn new(built_in: BuiltIn) -> Self {
        Self { built_in, written: BTreeMap::new(), asked: RefCell::new(None) }
    }

    /// Adds what a file says of a key; names and words of older presets become those of today.
    pub fn set(&mut self, key: &str, mut written: Written, place: Place) {
        let now = match RENAMED.iter().find(|(old, _)| *old == key) {
            Some((_, "")) => return,
            Some((_, now)) => now,
            None => key,
        };
        if ABSOLUTE.contains(&now) && written.first().contains('%') {
            return;
        }
        for value in &mut written.values {
            if let Some((.., meant)) = REWORDED.iter().find(|(key, old, _)| *key == now && old == value) {
                (*meant).clone_into(value);
            }
        }
        self.written.insert(now.to_owned(), (written, place));
    }

    /// Every key that is written.
    pub fn written(&self) -> impl Iterator<Item = (&str, &Written, &Place)> {
        self.written.iter().map(|(key, (written, place))| (key.as_str(), written, place))
    }

    /// Where a key is written.
    pub fn place(&self, key: &str) -> Option<&Place> {
        self.written.get(key).map(|(_, place)| place)
    }

    /// Where the last of the keys was written that were asked for since this was asked.
    pub fn asked(&self) -> Option<Place> {
        self.asked.borrow_mut().take()
    }

    /// All values of a key, as many as are written or built in.
    pub fn all(&self, name: &str) -> Vec<String> {
        let built_in = (self.built_in)(name);
        match self.written.get(name) {
            Some((written, place)) => {
                *self.asked.borrow_mut() = Some(place.clone());
                match built_in {
                    Some((kind, _)) if !written.is_list => split(kind, written.first()),
                    _ => written.values.clone(),
                }
            }
            None => match built_in {
                Some((Type { scalar: Scalar::Text, shape: Shape::One }, default)) => vec![unescaped(default)],
                Some((kind, default)) => split(kind, default),
                None => Vec::new(),
            },
        }
    }

    /// The first value of a key; empty: there is none.
    pub fn text(&self, name: &str) -> String {
        self.all(name).into_iter().next().unwrap_or_default()
    }

    /// A finite number.
    pub fn number(&self, name: &str) -> Option<f64> {
        number(&self.text(name))
    }

    /// A number, or a percentage of another.
    pub fn number_of(&self, name: &str, whole: Option<f64>) -> Option<f64> {
        let text = self.text(name);
        match text.trim().strip_suffix('%') {
            Some(percent) => Some(number(percent)? / 100.0 * whole?),
            None => number(&text),
        }
    }

    /// Whether a key asks for anything at all.
    pub fn is_on(&self, name: &str) -> bool {
        !self.all(name).iter().all(|value| is_off(value))
    }
}

/// Whether a value asks for nothing.
pub(super) fn is_off(value: &str) -> bool {
    const OFF: [&str; 11] =
        ["", "0", "0%", "0x0", "nil", "none", "nowhere", "disabled", "no ironing", "false", "Normal Lift"];
    OFF.contains(&value.trim().trim_matches('"'))
}

/// A number as it is written into configurations.
pub(super) fn written(number: f64) -> String {
    format!("{}", (number * 1e6).round() / 1e6)
}

fn number(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|number: &f64| number.is_finite())
}

/// The values in one text.
fn split(kind: Type, text: &str) -> Vec<String> {
    match kind {
        Type { shape: Shape::One, .. } => vec![text.to_owned()],
        Type { scalar: Scalar::Text, .. } => texts(text).into_iter().map(|text| text.into_owned()).collect(),
        _ if text.is_empty() => Vec::new(),
        _ => text.split(',').map(|value| value.trim().to_owned()).collect(),
    }
}
