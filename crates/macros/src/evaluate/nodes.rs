//! Parts of a script → text.

use super::assign::assign;
use super::context::Context;
use super::value::{self, value};
use crate::error::{Error, ErrorKind};
use crate::state::State;
use crate::syntax::{Bracket, Expression, Node};
use crate::{Names, Value};

/// What a script writes.
pub fn text(source: &str, nodes: &[Node], names: &dyn Names, state: &mut State) -> Result<String, Error> {
    let mut context = Context::new(source, names, state);
    write(&mut context, nodes)?;
    Ok(context.output)
}

/// Whether a condition holds.
pub fn flag(source: &str, condition: &Expression, names: &dyn Names) -> Result<bool, Error> {
    let mut state = State::default();
    let mut context = Context::new(source, names, &mut state);
    value::flag(&mut context, condition, "a condition is true or false")
}

fn write(context: &mut Context<'_>, nodes: &[Node]) -> Result<(), Error> {
    for node in nodes {
        match node {
            Node::Text(text) => context.write(text, 0)?,
            Node::Bracket(bracket) if context.ignores_brackets => context.write(&bracket.raw, bracket.at)?,
            Node::Bracket(bracket) => {
                let text = bracketed(context, bracket)?;
                context.write(&text, bracket.at)?;
            }
            Node::Print(expression) => {
                let text = value(context, expression)?.to_string();
                context.write(&text, expression.at)?;
            }
            Node::Assign(target, source) => assign(context, target, source)?,
            Node::If(branches, otherwise) => {
                let mut taken = otherwise;
                for (condition, nodes) in branches {
                    if value::flag(context, condition, "after `if` must stand a condition")? {
                        taken = nodes;
                        break;
                    }
                }
                write(context, taken)?;
            }
        }
    }
    Ok(())
}

/// `[name]`, `[name_0]` or `[name_[other]]`.
fn bracketed(context: &mut Context<'_>, bracket: &Bracket) -> Result<String, Error> {
    let Bracket { at, name, index, .. } = bracket;
    // The name itself, or what comes before its last underscore and the index.
    let (known, shorter) = match context.find(name) {
        Some(known) => (Some(known), None),
        None => match name.rsplit_once('_').filter(|(_, end)| index.is_none() || end.is_empty()) {
            Some((start, end)) => (context.find(start), Some(end)),
            None => (None, None),
        },
    };
    let known = known.ok_or_else(|| context.unknown(name, *at))?;
    let index = match (index, shorter) {
        (Some((at, index)), _) => match context.known(index, *at)?.as_ref() {
            Value::Integer(index) => Some(
                usize::try_from(*index)
                    .map_err(|_| context.error(*at, ErrorKind::Index, "an index must not be negative"))?,
            ),
            other => return Err(context.wrong(*at, "an index must be a whole number", other)),
        },
        (None, Some("")) => Some(0),
        (None, Some(end)) => match end.parse() {
            Ok(index) => Some(index),
            Err(_) => return Err(context.unknown(name, *at)),
        },
        (None, None) => None,
    };
    let element = context.element(&known, index, name, *at)?;
    if element.is_nil() {
        return Err(context.error(*at, ErrorKind::Nil, format!("`{name}` has no value here")));
    }
    let text = match known.as_ref() {
        Value::List(_) => element.element(),
        _ => element.bracketed(),
    };
    drop(known);
    context.work(text.len(), *at)?;
    Ok(text)
}
