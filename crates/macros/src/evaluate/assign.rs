//! What is assigned to variables and placeholders.

use super::context::Context;
use super::functions::whole;
use super::value::{index, value};
use crate::error::{Error, ErrorKind};
use crate::syntax::{Expression, Kind, Reference, Source, Target};
use crate::{Value, limits};

/// Where a value goes.
enum Place {
    Written,
    Global,
    Local,
}

/// What is assigned, with its place in the script.
enum Given {
    One(Value, usize),
    Many(Vec<(Value, usize)>),
}

/// An assignment.
pub fn assign(context: &mut Context<'_>, target: &Target, source: &Source) -> Result<(), Error> {
    match target {
        Target::New { at, name, global } => {
            let place = new_place(context, *at, name, *global)?;
            let old = context.variable(name).cloned();
            let given = given(context, source, old.as_ref().is_none_or(is_list))?;
            let value = match old {
                Some(old) => replaced(context, *at, name, &old, given)?,
                None if matches!(source, Source::List(items) if items.is_empty()) => {
                    let message = "a new vector needs an element, which says what it holds";
                    return Err(context.error(*at, ErrorKind::Assignment, message));
                }
                None => created(context, given)?,
            };
            store(context, *at, name, place, value)
        }
        Target::Existing(name) => {
            let place = old_place(context, name)?;
            let index = index(context, name)?;
            let old = context.known(&name.name, name.at)?.into_owned();
            context.work(old.size(), name.at)?;
            let given = given(context, source, index.is_none() && is_list(&old))?;
            let value = match index {
                None => replaced(context, name.at, &name.name, &old, given)?,
                Some(index) => with_element(context, name, old, index, given)?,
            };
            store(context, name.at, &name.name, place, value)
        }
    }
}

fn is_list(value: &Value) -> bool {
    matches!(value, Value::List(_))
}

/// Where a variable that is declared goes.
fn new_place(context: &Context<'_>, at: usize, name: &str, global: bool) -> Result<Place, Error> {
    let taken = if context.names.value(name).is_some() {
        "is a placeholder"
    } else if global && context.locals.contains_key(name) {
        "is a local variable"
    } else if !global && context.state.globals().contains_key(name) {
        "is a global variable"
    } else {
        return Ok(if global { Place::Global } else { Place::Local });
    };
    let message = format!("`{name}` {taken}; give the variable another name");
    Err(context.error(at, ErrorKind::Assignment, message))
}

/// Where what is there already goes.
fn old_place(context: &Context<'_>, name: &Reference) -> Result<Place, Error> {
    let known = &name.name;
    if context.names.is_writable(known) && context.names.value(known).is_some() {
        return Ok(Place::Written);
    }
    if context.names.value(known).is_some() {
        let message = format!("`{known}` cannot be written; keep the value in a variable (`local`)");
        return Err(context.error(name.at, ErrorKind::Assignment, message));
    }
    match (context.state.globals().contains_key(known), context.locals.contains_key(known)) {
        (true, _) => Ok(Place::Global),
        (_, true) => Ok(Place::Local),
        _ => {
            let mut error = context.unknown(known, name.at);
            error.message += "; a new variable is declared with `local` or `global`";
            Err(error)
        }
    }
}

/// What is assigned. A vector without an index is copied as a whole where it may be.
fn given(context: &mut Context<'_>, source: &Source, copies: bool) -> Result<Given, Error> {
    match source {
        Source::List(items) => {
            let mut values = Vec::with_capacity(items.len());
            for item in items {
                values.push((value(context, item)?, item.at));
            }
            Ok(Given::Many(values))
        }
        Source::Repeat(count, item) => {
            let times = match value(context, count)? {
                Value::Integer(times) => usize::try_from(times).ok(),
                _ => None,
            };
            let Some(times) = times.filter(|times| *times < limits::WORK) else {
                let message = "`repeat` needs a whole number of elements, and a value";
                return Err(context.error(count.at, ErrorKind::Type, message));
            };
            let element = value(context, item)?;
            context.work(times.saturating_mul(element.size()), count.at)?;
            Ok(Given::Many(vec![(element, item.at); times]))
        }
        Source::Value(expression) => {
            if copies
                && let Expression { kind: Kind::Reference(name), at } = expression
                && name.index.is_none()
                && let Value::List(items) = context.known(&name.name, name.at)?.as_ref()
            {
                let items = items.clone();
                context.work(items.iter().map(Value::size).sum(), *at)?;
                if items.iter().any(Value::is_nil) {
                    let message = format!("elements of `{}` have no value", name.name);
                    return Err(context.error(*at, ErrorKind::Nil, message));
                }
                return Ok(Given::Many(items.into_iter().map(|item| (plain(item), *at)).collect()));
            }
            Ok(Given::One(value(context, expression)?, expression.at))
        }
    }
}

/// Variables hold numbers instead of percentages, and texts instead of points.
fn plain(value: Value) -> Value {
    match value {
        Value::Percent(percent) => Value::Real(percent),
        Value::List(_) => Value::Text(value.to_string()),
        other => other,
    }
}

/// The value of a new variable: the elements of a vector are of one type.
fn created(context: &Context<'_>, given: Given) -> Result<Value, Error> {
    let values = match given {
        Given::One(value, _) => return Ok(value),
        Given::Many(values) => values,
    };
    let kind = [
        |value: &Value| matches!(value, Value::Text(_)),
        |value: &Value| matches!(value, Value::Flag(_)),
        |value: &Value| matches!(value, Value::Real(_)),
    ]
    .iter()
    .find_map(|is| values.iter().find(|(value, _)| is(value)))
    .or(values.first());
    let Some((kind, _)) = kind.cloned() else { return Ok(Value::List(Vec::new())) };
    fit_all(context, &kind, values)
}

/// What becomes of a value that is there when another is assigned: its type stays.
fn replaced(context: &Context<'_>, at: usize, name: &str, old: &Value, given: Given) -> Result<Value, Error> {
    match (old, given) {
        (Value::List(items), Given::Many(values)) => match items.first() {
            Some(kind) => fit_all(context, &kind.clone(), values),
            None if values.is_empty() => Ok(Value::List(Vec::new())),
            None => created(context, Given::Many(values)),
        },
        (Value::List(_), Given::One(..)) => {
            let message =
                format!("`{name}` is a vector; assign to an element (`{name}[0]`) or a list in (…)");
            Err(context.error(at, ErrorKind::Type, message))
        }
        (old, Given::One(value, value_at)) => fit(context, old, value, value_at),
        (old, Given::Many(mut values)) if values.len() == 1 => {
            let (value, value_at) = values.remove(0);
            fit(context, old, value, value_at)
        }
        _ => {
            let message = format!("`{name}` is no vector and cannot hold a list");
            Err(context.error(at, ErrorKind::Type, message))
        }
    }
}

/// A vector with another element.
fn with_element(
    context: &Context<'_>,
    name: &Reference,
    old: Value,
    index: usize,
    given: Given,
) -> Result<Value, Error> {
    let Value::List(mut items) = old else {
        let message = format!("`{}` is no vector and has no elements", name.name);
        return Err(context.error(name.at, ErrorKind::Type, message));
    };
    let Some(element) = items.get_mut(index) else {
        let message = format!("`{}` has {} elements, counted from 0", name.name, items.len());
        return Err(context.error(name.at, ErrorKind::Index, message));
    };
    *element = replaced(context, name.at, &name.name, element, given)?;
    Ok(Value::List(items))
}

fn fit_all(context: &Context<'_>, kind: &Value, values: Vec<(Value, usize)>) -> Result<Value, Error> {
    let fitted = values.into_iter().map(|(value, at)| fit(context, kind, value, at));
    fitted.collect::<Result<_, _>>().map(Value::List)
}

/// A value as the type of another.
fn fit(context: &Context<'_>, kind: &Value, value: Value, at: usize) -> Result<Value, Error> {
    match (kind, value) {
        (Value::Integer(_), Value::Real(real)) => whole(context, real.trunc(), at).map(Value::Integer),
        (Value::Real(_), Value::Integer(integer)) => Ok(Value::Real(integer as f64)),
        (Value::Percent(_), Value::Integer(integer)) => Ok(Value::Percent(integer as f64)),
        (Value::Percent(_), Value::Real(real)) => Ok(Value::Percent(real)),
        (Value::Text(_), value) => Ok(Value::Text(value.to_string())),
        (Value::Integer(_), value @ Value::Integer(_))
        | (Value::Real(_), value @ Value::Real(_))
        | (Value::Flag(_), value @ Value::Flag(_))
        | (Value::Nil, value) => Ok(value),
        (kind, value) => Err(context.wrong(at, &format!("this must be {}", kind.kind()), &value)),
    }
}

fn store(context: &mut Context<'_>, at: usize, name: &str, place: Place, value: Value) -> Result<(), Error> {
    context.work(value.size(), at)?;
    match place {
        Place::Global => return context.store_global(at, name, value),
        Place::Written => context.state.written.insert(name.to_owned(), value),
        Place::Local => context.locals.insert(name.to_owned(), value),
    };
    Ok(())
}
