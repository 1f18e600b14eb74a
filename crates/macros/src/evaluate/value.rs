//! Expressions → values.

use super::context::Context;
use super::functions;
use super::operators::chain;
use crate::Value;
use crate::error::{Error, ErrorKind};
use crate::syntax::{Expression, Kind, Reference};

/// The value of an expression, none for what writes nothing; never a vector, a percentage or nil.
pub fn value(context: &mut Context<'_>, expression: &Expression) -> Result<Value, Error> {
    let at = expression.at;
    context.work(1, at)?;
    Ok(match &expression.kind {
        Kind::Literal(value) => {
            context.work(value.size(), at)?;
            value.clone()
        }
        Kind::Reference(name) => scalar(context, name)?,
        Kind::Negative(inner) => match value(context, inner)? {
            Value::Integer(integer) => integer.checked_neg().map(Value::Integer).ok_or_else(|| {
                context.error(at, ErrorKind::Overflow, "the number is too large to be negated")
            })?,
            Value::Real(real) => Value::Real(-real),
            other => return Err(context.wrong(inner.at, "`-` needs a number", &other)),
        },
        Kind::Not(inner) => Value::Flag(!flag(context, inner, "`not` needs true or false")?),
        Kind::Chain(first, links) => {
            let first = value(context, first)?;
            chain(context, at, first, links, value)?
        }
        Kind::Choice(choices, rest) => {
            for (condition, chosen) in choices {
                if flag(context, condition, "before `?` must stand a condition")? {
                    return value(context, chosen);
                }
            }
            value(context, rest)?
        }
        Kind::Call(function, arguments) => {
            let mut values = Vec::with_capacity(arguments.len());
            for argument in arguments {
                values.push((value(context, argument)?, argument.at));
            }
            functions::call(context, at, *function, &values)?
        }
        Kind::IsNil(name) => {
            let index = index(context, name)?;
            let known = context.known(&name.name, name.at)?;
            Value::Flag(context.element(&known, index, &name.name, name.at)?.is_nil())
        }
        Kind::IsEmpty(name) => Value::Flag(length(context, name)? == 0),
        Kind::Size(name) => Value::Integer(length(context, name)? as i64),
        Kind::OneOf(text, cases) => functions::one_of(context, text, cases, value)?,
        Kind::Table(place, points) => functions::table(context, place, points, value)?,
        Kind::Exists(name) => {
            let exists = context.is_defined(name);
            if !exists {
                context.asked.insert(name.clone());
            }
            Value::Flag(exists)
        }
        Kind::Default(name, default) => {
            if !context.is_defined(name) {
                context.store_global(at, name, default.clone())?;
            }
            Value::Text(String::new())
        }
        Kind::IgnoreBrackets(ignores) => {
            context.ignores_brackets = *ignores;
            Value::Text(String::new())
        }
    })
}

/// A condition.
pub fn flag(context: &mut Context<'_>, expression: &Expression, needs: &str) -> Result<bool, Error> {
    match value(context, expression)? {
        Value::Flag(flag) => Ok(flag),
        other => Err(context.wrong(expression.at, needs, &other)),
    }
}

/// What an index is, if there is one.
pub fn index(context: &mut Context<'_>, name: &Reference) -> Result<Option<usize>, Error> {
    let Some(expression) = &name.index else { return Ok(None) };
    match value(context, expression)? {
        Value::Integer(index) => match usize::try_from(index) {
            Ok(index) => Ok(Some(index)),
            Err(_) => Err(context.error(expression.at, ErrorKind::Index, "an index must not be negative")),
        },
        other => Err(context.wrong(expression.at, "an index must be a whole number", &other)),
    }
}

/// A placeholder or variable as one value.
fn scalar(context: &mut Context<'_>, name: &Reference) -> Result<Value, Error> {
    let index = index(context, name)?;
    let known = context.known(&name.name, name.at)?;
    let element = context.element(&known, index, &name.name, name.at)?;
    if element.is_nil() {
        let message = format!("`{0}` has no value here; ask `is_nil({0})` before", name.name);
        return Err(context.error(name.at, ErrorKind::Nil, message));
    }
    let value = match element {
        Value::Percent(percent) => {
            Value::Real(context.names.whole(&name.name).map_or(*percent, |whole| whole * percent / 100.0))
        }
        Value::List(_) => Value::Text(element.to_string()),
        element => element.clone(),
    };
    drop(known);
    context.work(value.size(), name.at)?;
    Ok(value)
}

/// How many elements a vector has.
fn length(context: &mut Context<'_>, name: &Reference) -> Result<usize, Error> {
    match (context.known(&name.name, name.at)?.as_ref(), &name.index) {
        (Value::List(items), None) => Ok(items.len()),
        _ => {
            let message = format!("`{}` must be a vector here, without an index", name.name);
            Err(context.error(name.at, ErrorKind::Type, message))
        }
    }
}
