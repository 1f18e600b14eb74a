//! Settings of Cura in force: what definitions and containers say, one on top of the other, formulas worked out.

use std::cell::RefCell;
use std::collections::BTreeMap;

use super::formula::{self, Value};
use super::said::Said;
use crate::presets::config::Place;

/// Formulas ask for each other no deeper than this.
const DEEPEST: usize = 100;

/// Settings, those on top over those beneath.
#[derive(Debug, Default)]
pub(super) struct Stack {
    /// How many extruders the machine has; 0: that does not matter.
    pub extruders: usize,
    settings: BTreeMap<String, Said>,
    /// Those that not the slicer's own definitions said, but the machine or what it is used with.
    own: BTreeMap<String, ()>,
    worked_out: RefCell<BTreeMap<String, Result<Value, String>>>,
}

impl Stack {
    /// Adds a definition: its plain values do not hide formulas beneath.
    pub fn add_definition(&mut self, settings: &BTreeMap<String, Said>, is_own: bool) {
        for (key, said) in settings {
            let mut said = said.clone();
            if let Some(beneath) = self.settings.get(key) {
                said.formula = said.formula.or_else(|| beneath.formula.clone());
                said.plain = said.plain.or_else(|| beneath.plain.clone());
            }
            self.add(key, said, is_own);
        }
    }

    /// Adds a container: its values take the place of all beneath.
    pub fn add_values(&mut self, settings: &BTreeMap<String, Said>) {
        for (key, said) in settings {
            self.add(key, said.clone(), true);
        }
    }

    /// Adds one value.
    pub fn add_value(&mut self, key: &str, value: Value, place: Place) {
        self.add(key, Said { plain: Some(value), formula: None, place }, true);
    }

    fn add(&mut self, key: &str, said: Said, is_own: bool) {
        self.worked_out.borrow_mut().clear();
        self.settings.insert(key.to_owned(), said);
        if is_own {
            self.own.insert(key.to_owned(), ());
        }
    }

    /// Every setting that there is.
    pub fn keys(&self) -> impl Iterator<Item = &str> {
        self.settings.keys().map(String::as_str)
    }

    /// Where a setting is said.
    pub fn place(&self, key: &str) -> Option<&Place> {
        self.settings.get(key).map(|said| &said.place)
    }

    /// Where the machine, or what it is used with, says a setting; `None`: it is as built in.
    pub fn own_place(&self, key: &str) -> Option<&Place> {
        self.own.get(key).and_then(|()| self.place(key))
    }

    /// The formula of a setting.
    pub fn formula(&self, key: &str) -> Option<&str> {
        self.settings.get(key)?.formula.as_deref()
    }

    /// A setting's value.
    ///
    /// # Errors
    /// It is not there, or its formula is not understood.
    pub fn value(&self, key: &str) -> Result<Value, String> {
        self.value_at(key, 0)
    }

    fn value_at(&self, key: &str, depth: usize) -> Result<Value, String> {
        if let Some(known) = self.worked_out.borrow().get(key) {
            return known.clone();
        }
        if depth > DEEPEST {
            return Err(format!("`{key}` asks for itself"));
        }
        let Some(said) = self.settings.get(key) else { return Err(format!("there is no setting `{key}`")) };
        let value = match (&said.formula, &said.plain) {
            (Some(formula), _) => formula::evaluate(formula, &mut |name| self.value_at(name, depth + 1)),
            (None, Some(plain)) => Ok(plain.clone()),
            (None, None) => Ok(Value::Nothing),
        };
        self.worked_out.borrow_mut().insert(key.to_owned(), value.clone());
        value
    }

    /// A number.
    pub fn number(&self, key: &str) -> Option<f64> {
        self.value(key).ok()?.number()
    }

    /// Whether something is on.
    pub fn is_on(&self, key: &str) -> bool {
        self.value(key).is_ok_and(|value| value.holds())
    }

    /// A text, or a value as scripts show it.
    pub fn text(&self, key: &str) -> String {
        self.value(key).map(|value| value.written()).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(plain: Option<f64>, formula: Option<&str>) -> Said {
        let place = Place::new("x", 1, "");
        Said { plain: plain.map(Value::Number), formula: formula.map(str::to_owned), place }
    }

    #[test]
    fn formulas_beneath_hold_against_plain_values_of_definitions_alone() {
        let layer = |said: Said| BTreeMap::from([("a".to_owned(), said)]);
        let mut stack = Stack::default();
        stack.add_definition(&BTreeMap::from([("b".to_owned(), said(Some(2.0), None))]), false);
        stack.add_definition(&layer(said(Some(1.0), Some("b * 10"))), false);
        stack.add_definition(&layer(said(Some(5.0), None)), true);
        assert_eq!(stack.number("a"), Some(20.0));
        stack.add_values(&layer(said(Some(5.0), None)));
        assert_eq!(stack.number("a"), Some(5.0));
    }

    #[test]
    fn a_circle_of_formulas_is_an_error() {
        let mut stack = Stack::default();
        stack.add_definition(&BTreeMap::from([("a".to_owned(), said(None, Some("a + 1")))]), false);
        assert!(stack.value("a").unwrap_err().contains("asks for itself"));
    }
}
