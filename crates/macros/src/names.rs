//! Where placeholders come from.

use std::collections::BTreeMap;

use crate::Value;

/// The placeholders that a script may use.
///
/// A map is one, for the extruder 0 and without placeholders that scripts may write.
pub trait Names {
    /// What a placeholder holds; none where there is no such placeholder.
    fn value(&self, name: &str) -> Option<Value>;

    /// All placeholders, for suggestions in messages.
    fn names(&self) -> Vec<String>;

    /// The extruder in use, from 0: which element of a vector is meant that is written without an index.
    fn extruder(&self) -> usize {
        0
    }

    /// Whether scripts may assign to a placeholder.
    fn is_writable(&self, _name: &str) -> bool {
        false
    }

    /// What 100 % of a placeholder are, where its percentage is of another length or speed.
    ///
    /// `{name}` then is the share of it, `[name]` remains the percentage. Without, `{name}` is the number of percent.
    fn whole(&self, _name: &str) -> Option<f64> {
        None
    }
}

impl Names for BTreeMap<String, Value> {
    fn value(&self, name: &str) -> Option<Value> {
        self.get(name).cloned()
    }

    fn names(&self) -> Vec<String> {
        self.keys().cloned().collect()
    }
}
