//! What functions make of their arguments.

use super::context::{Context, Evaluate};
use crate::Value;
use crate::error::{Error, ErrorKind};
use crate::pattern::Pattern;
use crate::syntax::{Case, Expression, Function};

/// How far beyond the ends of a table a place may be, and how near its points are one.
const NEAR: f64 = 1e-4;

/// A function of values, which come with their places.
pub fn call(
    context: &mut Context<'_>,
    at: usize,
    function: Function,
    values: &[(Value, usize)],
) -> Result<Value, Error> {
    let number = |index: usize| {
        let (value, at) = &values[index];
        value.number().ok_or_else(|| context.wrong(*at, "this must be a number", value))
    };
    Ok(match function {
        Function::Int | Function::Round | Function::Floor | Function::Ceil => match values[0].0 {
            Value::Integer(integer) => Value::Integer(integer),
            _ => {
                let real = number(0)?;
                let real = match function {
                    Function::Round => real.round(),
                    Function::Floor => real.floor(),
                    Function::Ceil => real.ceil(),
                    _ => real.trunc(),
                };
                Value::Integer(whole(context, real, at)?)
            }
        },
        Function::Min | Function::Max | Function::Random => {
            let (a, b) = (number(0)?, number(1)?);
            match (&values[0].0, &values[1].0) {
                (Value::Integer(a), Value::Integer(b)) => Value::Integer(match function {
                    Function::Min => *a.min(b),
                    Function::Max => *a.max(b),
                    _ if a > b => return Err(empty_range(context, at)),
                    _ => context.state.random.integer(*a, *b),
                }),
                _ => Value::Real(match function {
                    Function::Min => a.min(b),
                    Function::Max => a.max(b),
                    _ if a > b || !(b - a).is_finite() => return Err(empty_range(context, at)),
                    _ => context.state.random.real(a, b),
                }),
            }
        }
        Function::Digits | Function::ZeroDigits => {
            let real = number(0)?;
            let count = |index: usize| match &values[index] {
                (Value::Integer(count), _) => Ok((*count).clamp(0, 64) as usize),
                (other, at) => Err(context.wrong(*at, "the number of digits must be a whole number", other)),
            };
            let width = count(1)?;
            let zeros = function == Function::ZeroDigits;
            if values.len() > 2 {
                let decimals = count(2)?;
                Value::Text(match zeros {
                    true => format!("{real:0width$.decimals$}"),
                    false => format!("{real:width$.decimals$}"),
                })
            } else {
                let integer = match values[0].0 {
                    Value::Integer(integer) => integer,
                    _ => whole(context, real.round(), at)?,
                };
                Value::Text(match zeros {
                    true => format!("{integer:0width$}"),
                    false => format!("{integer:width$}"),
                })
            }
        }
    })
}

fn empty_range(context: &Context<'_>, at: usize) -> Error {
    context.error(at, ErrorKind::Overflow, "`random` needs a smaller and then a larger number")
}

/// A whole number that is still held as a real one.
pub fn whole(context: &Context<'_>, real: f64, at: usize) -> Result<i64, Error> {
    match real.abs() < 9.2e18 {
        true => Ok(real as i64),
        false => Err(context.error(at, ErrorKind::Overflow, "the number is too large to be a whole one")),
    }
}

/// Whether a text is one of several, or matches one of several regular expressions.
pub fn one_of(
    context: &mut Context<'_>,
    text: &Expression,
    cases: &[Case],
    value: Evaluate,
) -> Result<Value, Error> {
    let needs = "`one_of` compares texts";
    let as_text = |context: &mut Context<'_>, expression: &Expression| match value(context, expression)? {
        Value::Text(text) => Ok(text),
        other => Err(context.wrong(expression.at, needs, &other)),
    };
    let text = as_text(context, text)?;
    let mut found = false;
    for case in cases {
        // All are evaluated, as mistakes must not hide behind a match.
        let matches = match case {
            Case::Text(other) => as_text(context, other)? == text,
            Case::TextPattern(pattern) => {
                let written = Pattern::new(as_text(context, pattern)?);
                context.matches(&written, &text, pattern.at)?
            }
            Case::Pattern(pattern, at) => context.matches(pattern, &text, *at)?,
        };
        found |= matches;
    }
    Ok(Value::Flag(found))
}

/// Where in a table of points, with straight lines between them.
pub fn table(
    context: &mut Context<'_>,
    place: &Expression,
    points: &[(Expression, Expression)],
    value: Evaluate,
) -> Result<Value, Error> {
    let number = |context: &mut Context<'_>, expression: &Expression| {
        let found = value(context, expression)?;
        found.number().ok_or_else(|| context.wrong(expression.at, "tables are of numbers", &found))
    };
    let x = number(context, place)?;
    let mut known: Vec<(f64, f64)> = Vec::with_capacity(points.len());
    for (left, right) in points {
        let point = (number(context, left)?, number(context, right)?);
        if known.last().is_some_and(|last| last.0 > point.0) {
            let message = "the first numbers of a table's points must increase";
            return Err(context.error(left.at, ErrorKind::Table, message));
        }
        known.push(point);
    }
    let within = known.windows(2).find(|pair| (pair[0].0..=pair[1].0).contains(&x));
    if let Some(&[(x0, y0), (x1, y1)]) = within {
        return Ok(Value::Real(match () {
            () if x == x0 => y0,
            () if x == x1 => y1,
            () if x1 - x0 < NEAR => 0.5 * (y0 + y1),
            () => y0 + (y1 - y0) * ((x - x0) / (x1 - x0)),
        }));
    }
    match (known.first(), known.last()) {
        (Some(first), _) if x <= first.0 && x > first.0 - NEAR => Ok(Value::Real(first.1)),
        (_, Some(last)) if x >= last.0 && x < last.0 + NEAR => Ok(Value::Real(last.1)),
        (Some(first), Some(last)) => {
            let message = format!(
                "{} is outside the table, which goes from {} to {}",
                Value::Real(x),
                Value::Real(first.0),
                Value::Real(last.0)
            );
            Err(context.error(place.at, ErrorKind::Table, message))
        }
        _ => Err(context.error(place.at, ErrorKind::Table, "the table has no points")),
    }
}
