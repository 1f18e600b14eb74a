//! The formulas in Cura's settings: expressions of Python, as far as settings need them.

use std::f64::consts::PI;

use geometry::real;

/// What a setting or a part of a formula is.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    Nothing,
    Flag(bool),
    Number(f64),
    Text(String),
    List(Vec<Value>),
}

impl Value {
    /// As Python takes it in a condition.
    pub fn holds(&self) -> bool {
        match self {
            Self::Nothing => false,
            Self::Flag(flag) => *flag,
            Self::Number(number) => *number != 0.0,
            Self::Text(text) => !text.is_empty(),
            Self::List(list) => !list.is_empty(),
        }
    }

    /// A flag counts as 0 or 1.
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Flag(flag) => Some(f64::from(u8::from(*flag))),
            Self::Number(number) => Some(*number),
            _ => None,
        }
    }

    /// As scripts show it.
    pub fn written(&self) -> String {
        match self {
            Self::Nothing => String::new(),
            Self::Flag(flag) => (if *flag { "True" } else { "False" }).to_owned(),
            Self::Number(number) => format!("{}", (number * 1e6).round() / 1e6),
            Self::Text(text) => text.clone(),
            Self::List(list) => list.iter().map(Self::written).collect::<Vec<_>>().join(","),
        }
    }
}

/// Formulas nest no deeper than this.
const DEEPEST: usize = 64;

#[derive(Clone, Debug, PartialEq)]
enum Token {
    Number(f64),
    Text(String),
    Name(String),
    Sign(&'static str),
}

/// Two characters before one, so that the longer is found first.
const SIGNS: [&str; 24] = [
    "**", "//", "<=", ">=", "==", "!=", "+", "-", "*", "/", "%", "<", ">", "(", ")", "[", "]", ",", ".", "{",
    "}", ":", "|", "&",
];

/// What a formula comes to; the setting of a name is asked for when it is needed.
///
/// # Errors
/// What is not understood.
pub(super) fn evaluate(
    formula: &str,
    settings: &mut dyn FnMut(&str) -> Result<Value, String>,
) -> Result<Value, String> {
    let tokens = tokens(formula)?;
    let mut reader = Reader { tokens: &tokens, at: 0, depth: 0, settings, is_live: true };
    let value = reader.choice()?;
    match reader.tokens.get(reader.at) {
        None => Ok(value),
        Some(token) => Err(format!("`{}` is not expected there", shown(token))),
    }
}

fn shown(token: &Token) -> String {
    match token {
        Token::Number(number) => number.to_string(),
        Token::Text(text) | Token::Name(text) => text.clone(),
        Token::Sign(sign) => (*sign).to_owned(),
    }
}

fn tokens(formula: &str) -> Result<Vec<Token>, String> {
    let mut out = Vec::new();
    let mut rest = formula.trim();
    while let Some(c) = rest.chars().next() {
        let length = |is_part: &dyn Fn(char) -> bool| rest.find(|c: char| !is_part(c)).unwrap_or(rest.len());
        let taken = if c.is_ascii_digit() || (c == '.' && rest[1..].starts_with(|c: char| c.is_ascii_digit()))
        {
            let end = length(&|c| c.is_ascii_digit() || c == '.');
            let number = rest[..end].parse().map_err(|_| format!("`{}` is no number", &rest[..end]))?;
            out.push(Token::Number(number));
            end
        } else if c.is_alphabetic() || c == '_' {
            let end = length(&|c| c.is_alphanumeric() || c == '_');
            out.push(Token::Name(rest[..end].to_owned()));
            end
        } else if c == '"' || c == '\'' {
            let end = rest[1..].find(c).ok_or("a text is not closed")?;
            out.push(Token::Text(rest[1..=end].to_owned()));
            end + 2
        } else {
            let sign = SIGNS.iter().find(|sign| rest.starts_with(**sign));
            let sign = sign.ok_or_else(|| format!("`{c}` is not understood"))?;
            out.push(Token::Sign(sign));
            sign.len()
        };
        rest = rest[taken..].trim_start();
    }
    Ok(out)
}

struct Reader<'a> {
    tokens: &'a [Token],
    at: usize,
    depth: usize,
    settings: &'a mut dyn FnMut(&str) -> Result<Value, String>,
    /// Whether what is read counts, and is not the branch that is not taken.
    is_live: bool,
}

type Outcome = Result<Value, String>;

impl Reader<'_> {
    fn takes_sign(&mut self, sign: &str) -> bool {
        let is_there = matches!(self.tokens.get(self.at), Some(Token::Sign(found)) if *found == sign);
        self.at += usize::from(is_there);
        is_there
    }

    fn takes_word(&mut self, word: &str) -> bool {
        let is_there = matches!(self.tokens.get(self.at), Some(Token::Name(found)) if found == word);
        self.at += usize::from(is_there);
        is_there
    }

    fn needs(&mut self, sign: &str) -> Result<(), String> {
        if self.takes_sign(sign) { Ok(()) } else { Err(format!("`{sign}` is missing")) }
    }

    /// Reads on; what is read counts only if it is wanted.
    fn if_wanted(&mut self, is_wanted: bool, read: fn(&mut Self) -> Outcome) -> Outcome {
        let before = self.is_live;
        self.is_live &= is_wanted;
        let value = read(self);
        self.is_live = before;
        value
    }

    /// `a if b else c`. The condition stands behind what it decides about, so that is read again.
    fn choice(&mut self) -> Outcome {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err("it is nested too deep".into());
        }
        let start = self.at;
        let mut value = self.if_wanted(false, Self::either)?;
        if self.takes_word("if") {
            let holds = self.either()?.holds();
            if !self.takes_word("else") {
                return Err("`else` is missing".into());
            }
            let other = self.if_wanted(!holds, Self::choice)?;
            value = other;
            if holds && self.is_live {
                let end = std::mem::replace(&mut self.at, start);
                value = self.either()?;
                self.at = end;
            }
        } else if self.is_live {
            self.at = start;
            value = self.either()?;
        }
        self.depth -= 1;
        Ok(value)
    }

    fn either(&mut self) -> Outcome {
        let mut value = self.both()?;
        while self.takes_word("or") {
            let is_wanted = !value.holds();
            let other = self.if_wanted(is_wanted, Self::both)?;
            value = if is_wanted { other } else { value };
        }
        Ok(value)
    }

    fn both(&mut self) -> Outcome {
        let mut value = self.negation()?;
        while self.takes_word("and") {
            let is_wanted = value.holds();
            let other = self.if_wanted(is_wanted, Self::negation)?;
            value = if is_wanted { other } else { value };
        }
        Ok(value)
    }

    fn negation(&mut self) -> Outcome {
        let mut is_negated = None;
        while self.takes_word("not") {
            is_negated = Some(!is_negated.unwrap_or(false));
        }
        let value = self.comparison()?;
        Ok(match is_negated {
            Some(is_negated) => Value::Flag(value.holds() != is_negated),
            None => value,
        })
    }

    fn comparison(&mut self) -> Outcome {
        let mut left = self.sum()?;
        let mut all: Option<bool> = None;
        loop {
            let Some(sign) = self.comparator() else { return Ok(all.map_or(left, Value::Flag)) };
            let right = self.sum()?;
            let holds = !self.is_live || compare(sign, &left, &right)?;
            all = Some(all.unwrap_or(true) && holds);
            left = right;
        }
    }

    fn comparator(&mut self) -> Option<&'static str> {
        if let Some(sign) = ["<=", ">=", "==", "!=", "<", ">"].into_iter().find(|sign| self.takes_sign(sign))
        {
            return Some(sign);
        }
        if self.takes_word("in") {
            return Some("in");
        }
        if matches!(self.tokens.get(self.at + 1), Some(Token::Name(word)) if word == "in")
            && self.takes_word("not")
        {
            self.at += 1;
            return Some("not in");
        }
        None
    }

    fn sum(&mut self) -> Outcome {
        let mut value = self.product()?;
        while let Some(sign) = ["+", "-"].into_iter().find(|sign| self.takes_sign(sign)) {
            let other = self.product()?;
            value = self.arithmetic(sign, value, other)?;
        }
        Ok(value)
    }

    fn product(&mut self) -> Outcome {
        let mut value = self.signed()?;
        while let Some(sign) = ["*", "//", "/", "%"].into_iter().find(|sign| self.takes_sign(sign)) {
            let other = self.signed()?;
            value = self.arithmetic(sign, value, other)?;
        }
        Ok(value)
    }

    fn signed(&mut self) -> Outcome {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err("it is nested too deep".into());
        }
        let value = if self.takes_sign("-") {
            let value = self.signed()?;
            self.arithmetic("-", Value::Number(0.0), value)
        } else if self.takes_sign("+") {
            self.signed()
        } else {
            let value = self.single()?;
            if self.takes_sign("**") {
                let other = self.signed()?;
                self.arithmetic("**", value, other)
            } else {
                Ok(value)
            }
        };
        self.depth -= 1;
        value
    }

    fn arithmetic(&self, sign: &str, left: Value, right: Value) -> Outcome {
        if !self.is_live {
            return Ok(Value::Nothing);
        }
        if let (Value::Text(left), "+", Value::Text(right)) = (&left, sign, &right) {
            return Ok(Value::Text(left.clone() + right));
        }
        let (Some(left), Some(right)) = (left.number(), right.number()) else {
            return Err(format!("`{sign}` is not between numbers"));
        };
        let result = match sign {
            "+" => left + right,
            "-" => left - right,
            "*" => left * right,
            "/" => left / right,
            "//" => (left / right).floor(),
            "%" => left - right * (left / right).floor(),
            _ => real::pow(left, right),
        };
        if result.is_finite() { Ok(Value::Number(result)) } else { Err(format!("`{sign}` has no result")) }
    }

    fn single(&mut self) -> Outcome {
        let token = self.tokens.get(self.at).cloned();
        self.at += 1;
        match token {
            Some(Token::Number(number)) => Ok(Value::Number(number)),
            Some(Token::Text(text)) => Ok(Value::Text(text)),
            Some(Token::Sign("(")) => {
                let mut values = self.values(")")?;
                match (values.pop(), values.is_empty()) {
                    (Some(only), true) => Ok(only),
                    (Some(last), false) => {
                        values.push(last);
                        Ok(Value::List(values))
                    }
                    (None, _) => Ok(Value::List(values)),
                }
            }
            Some(Token::Sign("[")) => Ok(Value::List(self.values("]")?)),
            Some(Token::Name(name)) => self.named(name),
            Some(other) => Err(format!("`{}` is not expected there", shown(&other))),
            None => Err("something is missing at its end".into()),
        }
    }

    /// Values with commas between them, up to a bracket.
    fn values(&mut self, end: &str) -> Result<Vec<Value>, String> {
        let mut values = Vec::new();
        while !self.takes_sign(end) {
            values.push(self.choice()?);
            if !self.takes_sign(",") {
                self.needs(end)?;
                break;
            }
        }
        Ok(values)
    }

    fn named(&mut self, mut name: String) -> Outcome {
        match name.as_str() {
            "True" => return Ok(Value::Flag(true)),
            "False" => return Ok(Value::Flag(false)),
            "None" => return Ok(Value::Nothing),
            _ => {}
        }
        while self.takes_sign(".") {
            match self.tokens.get(self.at) {
                Some(Token::Name(part)) => name = format!("{name}.{part}"),
                _ => return Err("a name is missing after `.`".into()),
            }
            self.at += 1;
        }
        if self.takes_sign("(") {
            let values = self.values(")")?;
            return if self.is_live { self.call(&name, &values) } else { Ok(Value::Nothing) };
        }
        match name.as_str() {
            "math.pi" => Ok(Value::Number(PI)),
            _ if self.is_live => (self.settings)(&name),
            _ => Ok(Value::Nothing),
        }
    }

    fn call(&mut self, name: &str, values: &[Value]) -> Outcome {
        let unknown = || Err(format!("`{name}` is not understood"));
        // There is one extruder, so that all of them is this one.
        match (name, values) {
            ("extruderValue", [_, Value::Text(key)]) | ("resolveOrValue", [Value::Text(key)]) => {
                return (self.settings)(key);
            }
            ("extruderValues", [Value::Text(key)]) => return Ok(Value::List(vec![(self.settings)(key)?])),
            ("defaultExtruderPosition", []) => return Ok(Value::Number(0.0)),
            ("len", [Value::Text(text)]) => return Ok(Value::Number(text.chars().count() as f64)),
            ("len", [Value::List(list)]) => return Ok(Value::Number(list.len() as f64)),
            ("any", [Value::List(list)]) => return Ok(Value::Flag(list.iter().any(Value::holds))),
            ("all", [Value::List(list)]) => return Ok(Value::Flag(list.iter().all(Value::holds))),
            ("str", [value]) => return Ok(Value::Text(value.written())),
            ("bool", [value]) => return Ok(Value::Flag(value.holds())),
            ("int" | "float", [Value::Text(text)]) => {
                return text.trim().parse().map(Value::Number).or_else(|_| unknown());
            }
            _ => {}
        }
        let flat = match values {
            [Value::List(list)] => list.as_slice(),
            other => other,
        };
        let numbers: Vec<f64> = match flat.iter().map(Value::number).collect::<Option<_>>() {
            Some(numbers) => numbers,
            None => return unknown(),
        };
        let result = match (name, numbers.as_slice()) {
            ("max", [first, rest @ ..]) => rest.iter().copied().fold(*first, f64::max),
            ("min", [first, rest @ ..]) => rest.iter().copied().fold(*first, f64::min),
            ("sum", all) => all.iter().sum(),
            ("abs" | "math.fabs", [x]) => x.abs(),
            ("float", [x]) => *x,
            ("int" | "math.trunc", [x]) => x.trunc(),
            ("round", [x]) => x.round_ties_even(),
            ("round", [x, digits]) if (0.0..=12.0).contains(digits) => {
                let scale = 10f64.powi(*digits as i32);
                (x * scale).round_ties_even() / scale
            }
            ("math.ceil", [x]) => x.ceil(),
            ("math.floor", [x]) => x.floor(),
            ("math.sqrt", [x]) => x.sqrt(),
            ("math.sin", [x]) => real::sin(*x),
            ("math.cos", [x]) => real::cos(*x),
            ("math.tan", [x]) => real::tan(*x),
            ("math.atan", [x]) => real::atan(*x),
            ("math.log", [x]) => real::ln(*x),
            ("math.radians", [x]) => x.to_radians(),
            ("math.degrees", [x]) => x.to_degrees(),
            ("math.pow" | "pow", [x, y]) => real::pow(*x, *y),
            _ => return unknown(),
        };
        if result.is_finite() { Ok(Value::Number(result)) } else { Err(format!("`{name}` has no result")) }
    }
}

fn compare(sign: &str, left: &Value, right: &Value) -> Result<bool, String> {
    let equal = || match (left.number(), right.number()) {
        (Some(left), Some(right)) => left == right,
        _ => left == right,
    };
    let within = || match (left, right) {
        (left, Value::List(list)) => Ok(list.contains(left)),
        (Value::Text(left), Value::Text(right)) => Ok(right.contains(left.as_str())),
        _ => Err("`in` is not about a list or text".to_owned()),
    };
    match sign {
        "==" => return Ok(equal()),
        "!=" => return Ok(!equal()),
        "in" => return within(),
        "not in" => return within().map(|is_in| !is_in),
        _ => {}
    }
    let (Some(left), Some(right)) = (left.number(), right.number()) else {
        return Err(format!("`{sign}` is not between numbers"));
    };
    Ok(match sign {
        "<" => left < right,
        ">" => left > right,
        "<=" => left <= right,
        _ => left >= right,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(formula: &str) -> Outcome {
        evaluate(formula, &mut |name| match name {
            "speed_print" => Ok(Value::Number(60.0)),
            "layer_height" => Ok(Value::Number(0.2)),
            "kind" => Ok(Value::Text("brim".into())),
            "on" => Ok(Value::Flag(true)),
            other => Err(format!("`{other}` is not there")),
        })
    }

    #[test]
    fn formulas_are_worked_out_as_python_would() {
        for (formula, result) in [
            ("speed_print / 2 + 1", 31.0),
            ("2 ** 3 - -1", 9.0),
            ("7 // 2 * 10 % 4", 2.0),
            ("10 if layer_height < 0.3 else 20 if on else 30", 10.0),
            ("10 if layer_height > 0.3 else 20 if on else missing", 20.0),
            ("max(1, min(extruderValues('speed_print')), 3)", 60.0),
            ("math.ceil(round(0.8 / resolveOrValue('layer_height'), 4))", 4.0),
            ("(1 if kind in ['brim', \"raft\"] and not on == False else 0) * 5", 5.0),
            ("1 if 0.1 < layer_height <= 0.2 else 0", 1.0),
            ("0 or 3", 3.0),
            ("round(2.5)", 2.0),
        ] {
            assert_eq!(value(formula), Ok(Value::Number(result)), "{formula}");
        }
        assert_eq!(value("'a' + 'b' if kind == 'brim' else ''"), Ok(Value::Text("ab".into())));
        assert_eq!(value("on and kind != 'none'"), Ok(Value::Flag(true)));
    }

    #[test]
    fn what_is_not_understood_is_said_and_nothing_ends_the_program() {
        for formula in
            ["", "1 +", "(1", "missing", "f(1)", "1 / 0", "'a' * 2", "a.", "1 2", "[x for x in y]", "\"", "§"]
        {
            assert!(value(formula).is_err(), "{formula}");
        }
        assert!(value(&"(".repeat(10_000)).is_err());
        assert!(value(&"-".repeat(10_000)).is_err());
        assert!(value(&"not ".repeat(10_000)).is_err());
    }
}
