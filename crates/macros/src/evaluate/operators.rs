//! What stands between values.

use std::cmp::Ordering;

use super::context::{Context, Evaluate};
use crate::Value;
use crate::error::{Error, ErrorKind};
use crate::syntax::{Link, Operator};

/// Real numbers nearer to each other than this are equal.
const EQUAL: f64 = 1e-8;

/// Operators of one rank from left to right.
pub fn chain(
    context: &mut Context<'_>,
    at: usize,
    mut left: Value,
    links: &[Link],
    value: Evaluate,
) -> Result<Value, Error> {
    for link in links {
        left = match link {
            Link::Operator(operator, right) => {
                let right_at = right.at;
                let right = value(context, right)?;
                apply(context, at, left, *operator, right, right_at)?
            }
            Link::Matches { pattern, at: pattern_at, wanted } => {
                let Value::Text(text) = &left else {
                    return Err(context.wrong(at, "a regular expression is compared with a text", &left));
                };
                Value::Flag(context.matches(pattern, text, *pattern_at)? == *wanted)
            }
        };
    }
    Ok(left)
}

fn apply(
    context: &Context<'_>,
    at: usize,
    left: Value,
    operator: Operator,
    right: Value,
    right_at: usize,
) -> Result<Value, Error> {
    use Operator::*;
    let flag = match operator {
        Or | And => {
            let needs = "`and` and `or` need true or false on both sides";
            let Value::Flag(left) = left else { return Err(context.wrong(at, needs, &left)) };
            let Value::Flag(right) = right else { return Err(context.wrong(right_at, needs, &right)) };
            if operator == Or { left || right } else { left && right }
        }
        Equal => compare(context, at, &left, &right)? == Some(Ordering::Equal),
        Unequal => compare(context, at, &left, &right)? != Some(Ordering::Equal),
        Less | LessOrEqual | Greater | GreaterOrEqual => {
            if matches!(left, Value::Flag(_)) && matches!(right, Value::Flag(_)) {
                return Err(context.wrong(at, "`<` and `>` need numbers or texts", &left));
            }
            let order = order(context, at, &left, &right)?;
            match operator {
                Less => order == Ordering::Less,
                LessOrEqual => order != Ordering::Greater,
                Greater => order == Ordering::Greater,
                _ => order != Ordering::Less,
            }
        }
        Add if matches!(left, Value::Text(_)) || matches!(right, Value::Text(_)) => {
            return Ok(Value::Text(join(left, &right)));
        }
        _ => return arithmetic(context, at, &left, operator, &right, right_at),
    };
    Ok(Value::Flag(flag))
}

/// The first text grows, so that a long sum of texts is not copied again and again.
fn join(left: Value, right: &Value) -> String {
    let mut text = match left {
        Value::Text(text) => text,
        other => other.to_string(),
    };
    match right {
        Value::Text(right) => text += right,
        other => text += &other.to_string(),
    }
    text
}

fn both_integers(left: &Value, right: &Value) -> Option<(i64, i64)> {
    match (left, right) {
        (Value::Integer(left), Value::Integer(right)) => Some((*left, *right)),
        _ => None,
    }
}

/// Equality, for which real numbers need only be nearly the same.
fn compare(context: &Context<'_>, at: usize, left: &Value, right: &Value) -> Result<Option<Ordering>, Error> {
    if both_integers(left, right).is_none()
        && let (Some(left), Some(right)) = (left.number(), right.number())
    {
        return Ok(((left - right).abs() < EQUAL).then_some(Ordering::Equal));
    }
    order(context, at, left, right).map(Some)
}

/// What comes first: numbers by size, texts by bytes; a text with anything else is a text.
fn order(context: &Context<'_>, at: usize, left: &Value, right: &Value) -> Result<Ordering, Error> {
    if let Some((left, right)) = both_integers(left, right) {
        return Ok(left.cmp(&right));
    }
    if let (Some(left), Some(right)) = (left.number(), right.number()) {
        return Ok(left.partial_cmp(&right).unwrap_or(Ordering::Equal));
    }
    match (left, right) {
        (Value::Flag(left), Value::Flag(right)) => Ok(left.cmp(right)),
        (Value::Text(left), Value::Text(right)) => Ok(left.cmp(right)),
        (Value::Text(_), _) | (_, Value::Text(_)) => Ok(left.to_string().cmp(&right.to_string())),
        _ => {
            let message = format!("{} cannot be compared with {}", left.kind(), right.kind());
            Err(context.error(at, ErrorKind::Type, message))
        }
    }
}

fn arithmetic(
    context: &Context<'_>,
    at: usize,
    left: &Value,
    operator: Operator,
    right: &Value,
    right_at: usize,
) -> Result<Value, Error> {
    let needs = match operator {
        Operator::Add => "`+` needs two numbers, or a text",
        Operator::Subtract => "`-` needs two numbers",
        Operator::Multiply => "`*` needs two numbers",
        Operator::Divide => "`/` needs two numbers",
        _ => "`%` needs two numbers",
    };
    let a = left.number().ok_or_else(|| context.wrong(at, needs, left))?;
    let b = right.number().ok_or_else(|| context.wrong(right_at, needs, right))?;
    if matches!(operator, Operator::Divide | Operator::Remainder) && b == 0.0 {
        return Err(context.error(right_at, ErrorKind::Division, "division by zero"));
    }
    let result = match both_integers(left, right) {
        Some((a, b)) => match operator {
            Operator::Add => a.checked_add(b),
            Operator::Subtract => a.checked_sub(b),
            Operator::Multiply => a.checked_mul(b),
            Operator::Divide => a.checked_div(b),
            _ => a.checked_rem(b),
        }
        .map(Value::Integer),
        None => Some(match operator {
            Operator::Add => a + b,
            Operator::Subtract => a - b,
            Operator::Multiply => a * b,
            Operator::Divide => a / b,
            _ => a % b,
        })
        .filter(|real| real.is_finite())
        .map(Value::Real),
    };
    result.ok_or_else(|| context.error(at, ErrorKind::Overflow, "the result is too large a number"))
}
