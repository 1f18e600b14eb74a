//! What holds for any script.

use std::collections::BTreeMap;

use pathwright_macros::{Script, State, Value, expand, holds};
use proptest::prelude::*;

/// Arithmetic as the test understands it.
#[derive(Clone, Debug)]
enum Sum {
    Integer(i64),
    /// Quarters.
    Real(i32),
    Negative(Box<Sum>),
    Pair(Box<Sum>, char, Box<Sum>),
}

#[derive(Clone, Copy, Debug)]
enum Number {
    Integer(i128),
    Real(f64),
}

impl Number {
    fn real(self) -> f64 {
        match self {
            Self::Integer(integer) => integer as f64,
            Self::Real(real) => real,
        }
    }
}

impl Sum {
    /// As it is written, with parentheses only where they are needed.
    fn script(&self) -> String {
        match self {
            Self::Integer(integer) => integer.to_string(),
            Self::Real(quarters) => format!("{:?}", f64::from(*quarters) / 4.0),
            Self::Negative(inner) => match **inner {
                Self::Pair(..) => format!("-({})", inner.script()),
                _ => format!("-{}", inner.script()),
            },
            Self::Pair(left, sign, right) => {
                let product = |sign: char| matches!(sign, '*' | '/' | '%');
                let left = match **left {
                    Self::Pair(_, inner, _) if product(*sign) && !product(inner) => {
                        format!("({})", left.script())
                    }
                    _ => left.script(),
                };
                let right = match **right {
                    Self::Pair(_, inner, _) if product(*sign) || !product(inner) => {
                        format!("({})", right.script())
                    }
                    _ => right.script(),
                };
                format!("{left} {sign}{right}")
            }
        }
    }

    /// What it comes to; nothing where a division by zero or a too large number is in it.
    fn number(&self) -> Option<Number> {
        let number = match self {
            Self::Integer(integer) => Number::Integer((*integer).into()),
            Self::Real(quarters) => Number::Real(f64::from(*quarters) / 4.0),
            Self::Negative(inner) => match inner.number()? {
                Number::Integer(integer) => Number::Integer(-integer),
                Number::Real(real) => Number::Real(-real),
            },
            Self::Pair(left, sign, right) => match (left.number()?, *sign, right.number()?) {
                (_, '/' | '%', b) if b.real() == 0.0 => return None,
                (Number::Integer(a), sign, Number::Integer(b)) => Number::Integer(match sign {
                    '+' => a + b,
                    '-' => a - b,
                    '*' => a * b,
                    '/' => a / b,
                    _ => a % b,
                }),
                (a, sign, b) => Number::Real(match sign {
                    '+' => a.real() + b.real(),
                    '-' => a.real() - b.real(),
                    '*' => a.real() * b.real(),
                    '/' => a.real() / b.real(),
                    _ => a.real() % b.real(),
                }),
            },
        };
        let fits = match number {
            Number::Integer(integer) => i64::try_from(integer).is_ok(),
            Number::Real(real) => real.is_finite(),
        };
        fits.then_some(number)
    }
}

fn sums() -> impl Strategy<Value = Sum> {
    let leaf = prop_oneof![
        (0_i64..20).prop_map(Sum::Integer),
        (0_i64..i64::MAX).prop_map(Sum::Integer),
        (0_i32..400).prop_map(Sum::Real),
    ];
    leaf.prop_recursive(6, 40, 2, |inner| {
        prop_oneof![
            1 => inner.clone().prop_map(|sum| Sum::Negative(Box::new(sum))),
            6 => (inner.clone(), prop::sample::select(vec!['+', '-', '*', '/', '%']), inner)
                .prop_map(|(left, sign, right)| Sum::Pair(Box::new(left), sign, Box::new(right))),
        ]
    })
}

/// Texts that are nearly scripts.
fn scripts() -> impl Strategy<Value = String> {
    let words = vec![
        "{",
        "}",
        "{{",
        "}}",
        "[",
        "]",
        "(",
        ")",
        "\"",
        "/",
        "\\",
        "\n",
        " ",
        ";",
        ",",
        "if ",
        "elsif ",
        "else ",
        "endif",
        "then ",
        "local a = ",
        "global b = ",
        "a",
        "b",
        "list",
        "flag",
        "text",
        "1",
        "2.5",
        "0",
        "=",
        "==",
        "=~ /a.*/",
        "!~",
        "+",
        "-",
        "*",
        "%",
        "?",
        ":",
        "!",
        "not ",
        "and ",
        "or ",
        "min(",
        "digits(",
        "random(",
        "one_of(",
        "interpolate_table(",
        "repeat(",
        "size(",
        "is_nil(",
        "empty(",
        "exists(",
        "true",
        "é",
        "G1 X",
    ];
    let word = prop_oneof![9 => prop::sample::select(words).prop_map(str::to_owned), 1 => any::<String>()];
    prop::collection::vec(word, 0..40).prop_map(|words| words.concat())
}

fn names() -> BTreeMap<String, Value> {
    BTreeMap::from([
        ("list".into(), vec![1, 2].into()),
        ("flag".into(), Value::Flag(true)),
        ("text".into(), "abc".into()),
    ])
}

proptest! {
    #[test]
    fn arithmetic_is_that_of_the_numbers(sum in sums()) {
        let text = expand(&format!("{{{}}}", sum.script()), &names(), &mut State::default());
        match sum.number() {
            Some(Number::Integer(integer)) => prop_assert_eq!(text.unwrap(), integer.to_string()),
            Some(number) => {
                let (text, real) = (text.unwrap(), number.real());
                let near = (text.parse::<f64>().unwrap() - real).abs() <= 5.1e-6 * real.abs().max(1e-9);
                prop_assert!(near, "{} for {}", text, real);
            }
            None => prop_assert!(text.is_err()),
        }
    }

    #[test]
    fn any_text_ends_in_a_result_or_an_error_within_it(script in scripts()) {
        let mut state = State::default();
        let first = expand(&script, &names(), &mut state);
        prop_assert_eq!(&first, &expand(&script, &names(), &mut State::default()));
        for error in [first.err(), holds(&script, &names()).err()].into_iter().flatten() {
            let line = script.split('\n').nth(error.line - 1);
            prop_assert!(line.is_some_and(|line| error.column <= line.chars().count() + 1), "{}", error);
        }
    }

    #[test]
    fn text_without_brackets_stays(text in r"[^\[{\\]*") {
        prop_assert_eq!(expand(&text, &names(), &mut State::default()).unwrap(), text);
    }

    #[test]
    fn a_text_in_quotes_is_what_it_stands_for(text in any::<String>()) {
        let quoted = text.replace('\\', r"\\").replace('"', "\\\"");
        prop_assert_eq!(expand(&format!("{{\"{quoted}\"}}"), &names(), &mut State::default()).unwrap(), text);
    }

    #[test]
    fn reals_have_six_digits(real in prop::num::f64::NORMAL) {
        let text = Value::Real(real).to_string();
        let back: f64 = text.parse().unwrap();
        prop_assert!((back / real - 1.0).abs() <= 5.000_001e-6, "{}", text);
        prop_assert_eq!(Value::Real(back).to_string(), text);
    }

    #[test]
    fn random_numbers_are_in_their_range(a in any::<i32>(), b in any::<i32>(), seed in any::<u64>()) {
        let (a, b) = (a.min(b), a.max(b));
        let script = Script::parse(&format!("{{random({a}, {b})}} {{random({a}., {b})}}")).unwrap();
        let text = script.expand(&names(), &mut State::new(seed)).unwrap();
        let (integer, real) = text.split_once(' ').unwrap();
        prop_assert!((a..=b).contains(&integer.parse().unwrap()));
        let slack = 5e-6 * f64::from(a).abs().max(f64::from(b).abs());
        prop_assert!((f64::from(a) - slack..=f64::from(b) + slack).contains(&real.parse().unwrap()));
    }
}
