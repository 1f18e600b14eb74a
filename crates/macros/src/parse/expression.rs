//! Tokens → expressions.

use super::scanner::{Scanner, Token};
use crate::Value;
use crate::error::Error;
use crate::syntax::{Case, Expression, Function, KEYWORDS, Kind, Link, Operator, Reference};

/// The operators from those that bind least; the sixth rank is what they stand between.
const RANKS: [&[(&str, Operator)]; 6] = [
    &[("or", Operator::Or), ("||", Operator::Or)],
    &[("and", Operator::And), ("&&", Operator::And)],
    &[("==", Operator::Equal), ("!=", Operator::Unequal), ("<>", Operator::Unequal)],
    &[
        ("<=", Operator::LessOrEqual),
        (">=", Operator::GreaterOrEqual),
        ("<", Operator::Less),
        (">", Operator::Greater),
    ],
    &[("+", Operator::Add), ("-", Operator::Subtract)],
    &[("*", Operator::Multiply), ("/", Operator::Divide), ("%", Operator::Remainder)],
];
/// The rank that has `=~` and `!~`, too.
const EQUALITY: usize = 2;

/// An expression, which may be a choice (`?:`).
pub fn expression(scanner: &mut Scanner<'_>) -> Result<Expression, Error> {
    scanner.nested(|scanner| {
        let at = scanner.start;
        let mut rest = operators(scanner, 0)?;
        let mut choices = Vec::new();
        while scanner.skip_sign("?")? {
            let chosen = expression(scanner)?;
            scanner.need_sign(":")?;
            choices.push((rest, chosen));
            rest = operators(scanner, 0)?;
        }
        match choices.is_empty() {
            true => Ok(rest),
            false => Ok(Expression { at, kind: Kind::Choice(choices, Box::new(rest)) }),
        }
    })
}

/// Operators of one rank and what is between them.
fn operators(scanner: &mut Scanner<'_>, rank: usize) -> Result<Expression, Error> {
    let Some(known) = RANKS.get(rank) else { return unary(scanner) };
    let at = scanner.start;
    let first = operators(scanner, rank + 1)?;
    let mut links = Vec::new();
    loop {
        let found = match scanner.token {
            Token::Sign(sign) => sign,
            Token::Word(word) => word,
            _ => break,
        };
        if rank == EQUALITY && matches!(found, "=~" | "!~") {
            let wanted = found == "=~";
            let (pattern, at) = scanner.pattern(scanner.end)?;
            links.push(Link::Matches { pattern, at, wanted });
        } else if let Some((_, operator)) = known.iter().find(|(text, _)| *text == found) {
            scanner.advance()?;
            links.push(Link::Operator(*operator, operators(scanner, rank + 1)?));
        } else {
            break;
        }
    }
    match links.is_empty() {
        true => Ok(first),
        false => Ok(Expression { at, kind: Kind::Chain(Box::new(first), links) }),
    }
}

/// A value with the signs before it.
fn unary(scanner: &mut Scanner<'_>) -> Result<Expression, Error> {
    let at = scanner.start;
    let kind = match scanner.token.clone() {
        Token::Sign("-") => {
            scanner.advance()?;
            Kind::Negative(Box::new(scanner.nested(unary)?))
        }
        Token::Sign("+") => {
            scanner.advance()?;
            return scanner.nested(unary);
        }
        Token::Sign("!") | Token::Word("not") => {
            scanner.advance()?;
            Kind::Not(Box::new(scanner.nested(unary)?))
        }
        Token::Sign("(") => {
            scanner.advance()?;
            let inner = expression(scanner)?;
            scanner.need_sign(")")?;
            return Ok(inner);
        }
        Token::Word("true") => literal(scanner, Value::Flag(true))?,
        Token::Word("false") => literal(scanner, Value::Flag(false))?,
        Token::Integer(integer) => literal(scanner, Value::Integer(integer))?,
        Token::Real(real) => literal(scanner, Value::Real(real))?,
        Token::Text(text) => literal(scanner, Value::Text(text))?,
        Token::Word(word) => match scanner.nested(|scanner| call(scanner, word))? {
            Some(kind) => kind,
            None if KEYWORDS.contains(&word) => return Err(scanner.expected("an expression")),
            None => Kind::Reference(reference(scanner)?),
        },
        _ => return Err(scanner.expected("an expression")),
    };
    Ok(Expression { at, kind })
}

fn literal(scanner: &mut Scanner<'_>, value: Value) -> Result<Kind, Error> {
    scanner.advance()?;
    Ok(Kind::Literal(value))
}

/// A name that is no keyword, and where it is.
pub fn name(scanner: &mut Scanner<'_>) -> Result<(usize, String), Error> {
    match scanner.token {
        Token::Word(word) if !KEYWORDS.contains(&word) => {
            let at = scanner.start;
            scanner.advance()?;
            Ok((at, word.to_owned()))
        }
        _ => Err(scanner.expected("a name")),
    }
}

/// A name, perhaps with an index.
pub fn reference(scanner: &mut Scanner<'_>) -> Result<Reference, Error> {
    let (at, name) = name(scanner)?;
    let mut index = None;
    if scanner.skip_sign("[")? {
        index = Some(Box::new(expression(scanner)?));
        scanner.need_sign("]")?;
    }
    Ok(Reference { at, name, index })
}

/// A function with its arguments, if the word is one.
fn call(scanner: &mut Scanner<'_>, word: &str) -> Result<Option<Kind>, Error> {
    // Functions of SuperSlicer alone are no keywords: names of others may be like them.
    let mark = scanner.mark();
    scanner.advance()?;
    if !scanner.is_sign("(") {
        scanner.back(mark);
        return Ok(None);
    }
    scanner.advance()?;
    let kind = match word {
        "min" => Kind::Call(Function::Min, arguments(scanner, 2, 2)?),
        "max" => Kind::Call(Function::Max, arguments(scanner, 2, 2)?),
        "random" => Kind::Call(Function::Random, arguments(scanner, 2, 2)?),
        "digits" => Kind::Call(Function::Digits, arguments(scanner, 2, 3)?),
        "zdigits" => Kind::Call(Function::ZeroDigits, arguments(scanner, 2, 3)?),
        "int" => Kind::Call(Function::Int, arguments(scanner, 1, 1)?),
        "round" => Kind::Call(Function::Round, arguments(scanner, 1, 1)?),
        "floor" => Kind::Call(Function::Floor, arguments(scanner, 1, 1)?),
        "ceil" => Kind::Call(Function::Ceil, arguments(scanner, 1, 1)?),
        "is_nil" => Kind::IsNil(reference(scanner)?),
        "empty" => Kind::IsEmpty(reference(scanner)?),
        "size" => Kind::Size(reference(scanner)?),
        "one_of" => one_of(scanner)?,
        "interpolate_table" => table(scanner)?,
        "exists" => Kind::Exists(name(scanner)?.1),
        "default_bool" | "default_int" | "default_double" | "default_string" => {
            let (_, name) = name(scanner)?;
            scanner.need_sign(",")?;
            Kind::Default(name, default_value(scanner, word)?)
        }
        "ignore_legacy" => match default_value(scanner, "default_bool")? {
            Value::Flag(ignore) => Kind::IgnoreBrackets(ignore),
            _ => return Err(scanner.expected("`true` or `false`")),
        },
        _ => {
            scanner.back(mark);
            return Ok(None);
        }
    };
    scanner.need_sign(")")?;
    Ok(Some(kind))
}

/// Expressions with commas between them.
fn arguments(scanner: &mut Scanner<'_>, least: usize, most: usize) -> Result<Vec<Expression>, Error> {
    let mut all = vec![expression(scanner)?];
    while all.len() < least || (all.len() < most && scanner.is_sign(",")) {
        scanner.need_sign(",")?;
        all.push(expression(scanner)?);
    }
    Ok(all)
}

/// A text and what it may be; the commas after the first may be left out.
fn one_of(scanner: &mut Scanner<'_>) -> Result<Kind, Error> {
    let text = scanner.nested(unary)?;
    let mut cases = Vec::new();
    if scanner.skip_sign(",")? {
        while !scanner.is_sign(")") {
            cases.push(if scanner.is_sign("/") {
                let (pattern, at) = scanner.pattern(scanner.start)?;
                Case::Pattern(pattern, at)
            } else if scanner.skip_sign("~")? {
                Case::TextPattern(scanner.nested(unary)?)
            } else {
                Case::Text(scanner.nested(unary)?)
            });
            scanner.skip_sign(",")?;
        }
    }
    Ok(Kind::OneOf(Box::new(text), cases))
}

/// Where, and the points of a table; the commas between the points may be left out.
fn table(scanner: &mut Scanner<'_>) -> Result<Kind, Error> {
    let place = expression(scanner)?;
    scanner.need_sign(",")?;
    let mut points = Vec::new();
    while scanner.skip_sign("(")? {
        let x = expression(scanner)?;
        scanner.need_sign(",")?;
        points.push((x, expression(scanner)?));
        scanner.need_sign(")")?;
        scanner.skip_sign(",")?;
    }
    Ok(Kind::Table(Box::new(place), points))
}

/// The second argument of SuperSlicer's `default_…`: a value written out.
fn default_value(scanner: &mut Scanner<'_>, function: &str) -> Result<Value, Error> {
    let sign = if scanner.skip_sign("-")? { -1 } else { 1 };
    let value = match (function, scanner.token.clone()) {
        ("default_bool", Token::Word("true")) if sign == 1 => Value::Flag(true),
        ("default_bool", Token::Word("false")) if sign == 1 => Value::Flag(false),
        ("default_int", Token::Integer(integer)) => Value::Integer(sign * integer),
        ("default_double", Token::Integer(integer)) => Value::Real((sign * integer) as f64),
        ("default_double", Token::Real(real)) => Value::Real(sign as f64 * real),
        ("default_string", Token::Text(text)) if sign == 1 => Value::Text(text),
        ("default_bool", _) => return Err(scanner.expected("`true` or `false`")),
        ("default_string", _) => return Err(scanner.expected("a text in quotes")),
        _ => return Err(scanner.expected("a number")),
    };
    scanner.advance()?;
    Ok(value)
}
