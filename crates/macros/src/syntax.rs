//! A script as a tree.

use crate::Value;
use crate::pattern::Pattern;

/// A part of a script. Places (`at`) are bytes of the script.
#[derive(Debug)]
pub enum Node {
    /// What is written as it stands.
    Text(String),
    /// `[name]`, `[name_0]`, `[name_[other]]`.
    Bracket(Bracket),
    /// `{expression}`.
    Print(Expression),
    /// `{if}`, `{elsif}` and what follows each, and what follows `{else}`.
    If(Vec<(Expression, Vec<Node>)>, Vec<Node>),
    /// `name = …`, `local name = …`.
    Assign(Target, Source),
}

/// A name in brackets within the text.
#[derive(Debug)]
pub struct Bracket {
    pub at: usize,
    pub name: String,
    /// The name in the inner brackets, and where it is.
    pub index: Option<(usize, String)>,
    /// How it stands in the script.
    pub raw: String,
}

/// What is assigned to.
#[derive(Debug)]
pub enum Target {
    Existing(Reference),
    New { at: usize, name: String, global: bool },
}

/// What is assigned.
#[derive(Debug)]
pub enum Source {
    /// `(a, b, c)`
    List(Vec<Expression>),
    /// `repeat(count, value)`
    Repeat(Expression, Expression),
    Value(Expression),
}

/// A name, perhaps with an index.
#[derive(Debug)]
pub struct Reference {
    pub at: usize,
    pub name: String,
    pub index: Option<Box<Expression>>,
}

#[derive(Debug)]
pub struct Expression {
    pub at: usize,
    pub kind: Kind,
}

#[derive(Debug)]
pub enum Kind {
    Literal(Value),
    Reference(Reference),
    Negative(Box<Expression>),
    Not(Box<Expression>),
    /// Operators of one rank, from left to right.
    Chain(Box<Expression>, Vec<Link>),
    /// `a ? b : c ? d : e`: conditions with what they choose, and the rest.
    Choice(Vec<(Expression, Expression)>, Box<Expression>),
    Call(Function, Vec<Expression>),
    IsNil(Reference),
    IsEmpty(Reference),
    Size(Reference),
    OneOf(Box<Expression>, Vec<Case>),
    /// Where in a table of points.
    Table(Box<Expression>, Vec<(Expression, Expression)>),
    Exists(String),
    Default(String, Value),
    IgnoreBrackets(bool),
}

/// An operator and what stands to its right.
#[derive(Debug)]
pub enum Link {
    Operator(Operator, Expression),
    /// `=~ /…/`, or `!~ /…/` where it must not match.
    Matches {
        pattern: Pattern,
        at: usize,
        wanted: bool,
    },
}

/// What `one_of` compares with.
#[derive(Debug)]
pub enum Case {
    Text(Expression),
    /// `~"…"`: a text that is a regular expression.
    TextPattern(Expression),
    Pattern(Pattern, usize),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operator {
    Or,
    And,
    Equal,
    Unequal,
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
    Add,
    Subtract,
    Multiply,
    Divide,
    Remainder,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Function {
    Min,
    Max,
    Random,
    Digits,
    ZeroDigits,
    Int,
    Round,
    Floor,
    Ceil,
}

/// Words that cannot be names.
pub const KEYWORDS: &[&str] = &[
    "and",
    "ceil",
    "digits",
    "else",
    "elsif",
    "empty",
    "endif",
    "false",
    "floor",
    "global",
    "if",
    "int",
    "interpolate_table",
    "is_nil",
    "local",
    "max",
    "min",
    "not",
    "one_of",
    "or",
    "random",
    "repeat",
    "round",
    "size",
    "then",
    "true",
    "zdigits",
];
