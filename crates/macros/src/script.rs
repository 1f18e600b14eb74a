//! Scripts and conditions, parsed once and evaluated often.

use crate::syntax::{Expression, Node};
use crate::{Error, Names, State, evaluate, parse};

/// A script: text with code in braces.
///
/// ```
/// use pathwright_macros::{Script, State, Value};
///
/// let script = Script::parse(";Z{digits(layer_z, 7, 3)}")?;
/// let mut state = State::default();
/// let at = |z: f64| std::collections::BTreeMap::from([("layer_z".to_owned(), Value::Real(z))]);
/// assert_eq!(script.expand(&at(0.2), &mut state)?, ";Z  0.200");
/// assert_eq!(script.expand(&at(10.4), &mut state)?, ";Z 10.400");
/// # Ok::<(), pathwright_macros::Error>(())
/// ```
#[derive(Debug)]
pub struct Script {
    source: String,
    nodes: Vec<Node>,
}

impl Script {
    /// Reads a script; names need not be known yet.
    ///
    /// # Errors
    /// What is wrong with its syntax.
    pub fn parse(source: &str) -> Result<Self, Error> {
        Ok(Self { nodes: parse::script(source)?, source: source.to_owned() })
    }

    /// What the script writes.
    ///
    /// # Errors
    /// What goes wrong in the branches that are taken.
    pub fn expand(&self, names: &dyn Names, state: &mut State) -> Result<String, Error> {
        evaluate::text(&self.source, &self.nodes, names, state)
    }
}

/// An expression that is true or false, such as a preset's `compatible_printers_condition`.
///
/// ```
/// use pathwright_macros::{Condition, Value};
///
/// let condition = Condition::parse("nozzle_diameter[0] == 0.4 and num_extruders == 1")?;
/// let names = std::collections::BTreeMap::from([
///     ("nozzle_diameter".to_owned(), Value::from(vec![0.4])),
///     ("num_extruders".to_owned(), Value::Integer(1)),
/// ]);
/// assert!(condition.holds(&names)?);
/// # Ok::<(), pathwright_macros::Error>(())
/// ```
#[derive(Debug)]
pub struct Condition {
    source: String,
    condition: Option<Expression>,
}

impl Condition {
    /// Reads a condition; names need not be known yet.
    ///
    /// # Errors
    /// What is wrong with its syntax.
    pub fn parse(source: &str) -> Result<Self, Error> {
        Ok(Self { condition: parse::condition(source)?, source: source.to_owned() })
    }

    /// Whether the condition is true; an empty one is.
    ///
    /// # Errors
    /// What cannot be evaluated.
    pub fn holds(&self, names: &dyn Names) -> Result<bool, Error> {
        self.condition.as_ref().map_or(Ok(true), |condition| evaluate::flag(&self.source, condition, names))
    }
}

/// What a script writes.
///
/// # Errors
/// What is wrong with the script.
pub fn expand(script: &str, names: &dyn Names, state: &mut State) -> Result<String, Error> {
    Script::parse(script)?.expand(names, state)
}

/// Whether a condition is true; an empty one is.
///
/// # Errors
/// What is wrong with the condition.
pub fn holds(condition: &str, names: &dyn Names) -> Result<bool, Error> {
    Condition::parse(condition)?.holds(names)
}
