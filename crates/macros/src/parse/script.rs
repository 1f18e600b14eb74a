//! Text with code in braces → parts.

use super::expression::{expression, name, reference};
use super::scanner::{Scanner, Token};
use crate::error::{Error, ErrorKind};
use crate::near::nearest;
use crate::syntax::{Bracket, Expression, KEYWORDS, Kind, Node, Source, Target};

/// A whole script.
pub fn script(source: &str) -> Result<Vec<Node>, Error> {
    let mut parser = Parser { scanner: Scanner::new(source)?, braces: 0 };
    let mut nodes = Vec::new();
    match parser.text(0, &mut nodes)? {
        None => Ok(nodes),
        Some(_) => {
            let Token::Word(word) = parser.scanner.token else { return Err(parser.scanner.expected("text")) };
            let message = format!("`{word}` without an `if` before it");
            Err(parser.scanner.error(parser.scanner.start, ErrorKind::Syntax, message))
        }
    }
}

/// A condition without braces; none where there is only white space.
pub fn condition(source: &str) -> Result<Option<Expression>, Error> {
    let mut scanner = Scanner::new(source)?;
    scanner.enter(0)?;
    if scanner.token == Token::End {
        return Ok(None);
    }
    let condition = expression(&mut scanner)?;
    match scanner.token {
        Token::End => Ok(Some(condition)),
        _ => Err(scanner.expected("an operator or the end of the condition")),
    }
}

struct Parser<'a> {
    scanner: Scanner<'a>,
    /// How many `{{` of this line are not closed by a `}}` yet.
    braces: usize,
}

impl<'a> Parser<'a> {
    /// Text from a byte on, up to the end, or up to a brace that is followed by `elsif`, `else` or `endif`, which the
    /// scanner then looks at; returns where that brace is.
    fn text(&mut self, from: usize, nodes: &mut Vec<Node>) -> Result<Option<usize>, Error> {
        let source = self.scanner.source;
        let mut at = from;
        let mut text = String::new();
        loop {
            let rest = &source[at..];
            let Some(found) = rest.find(['{', '}', '[', '\\', '\n']) else {
                text += rest;
                push_text(nodes, text);
                return Ok(None);
            };
            text += &rest[..found];
            at += found;
            let rest = &source[at..];
            let literal = match () {
                () if rest.starts_with("{{") => {
                    self.braces += 1;
                    Some(("{", 2))
                }
                () if rest.starts_with("}}") && self.braces > 0 => {
                    self.braces -= 1;
                    Some(("}", 2))
                }
                () if rest.starts_with('\n') => {
                    self.braces = 0;
                    Some(("\n", 1))
                }
                () if rest.starts_with("\\[") => Some(("[", 2)),
                () if rest.starts_with("\\{") => Some(("{", 2)),
                () if rest.starts_with(['}', '\\']) => Some((&rest[..1], 1)),
                () => None,
            };
            if let Some((literal, length)) = literal {
                text += literal;
                at += length;
                continue;
            }
            push_text(nodes, std::mem::take(&mut text));
            if rest.starts_with('[') {
                at = self.bracket(at, nodes)?;
                continue;
            }
            self.scanner.enter(at + 1)?;
            if matches!(self.scanner.token, Token::Word("elsif" | "else" | "endif")) {
                return Ok(Some(at));
            }
            at = self.code(at, nodes)?;
        }
    }

    /// `[name]`, `[name_[index]]`; returns where the text goes on.
    fn bracket(&mut self, at: usize, nodes: &mut Vec<Node>) -> Result<usize, Error> {
        let scanner = &mut self.scanner;
        scanner.enter(at + 1)?;
        let (name_at, word) = name(scanner)?;
        let mut index = None;
        if scanner.skip_sign("[")? {
            index = Some(name(scanner)?);
            scanner.need_sign("]")?;
        }
        if !scanner.is_sign("]") {
            return Err(scanner.expected("`]`"));
        }
        let raw = scanner.source[at..scanner.end].to_owned();
        nodes.push(Node::Bracket(Bracket { at: name_at, name: word, index, raw }));
        Ok(scanner.end)
    }

    /// Statements up to the closing brace; returns where the text goes on.
    fn code(&mut self, open: usize, nodes: &mut Vec<Node>) -> Result<usize, Error> {
        if self.scanner.is_sign("}") {
            return Err(self.scanner.expected("an expression"));
        }
        self.statements(nodes, |scanner| scanner.is_sign("}"))?;
        match self.scanner.is_sign("}") {
            true => Ok(self.scanner.end),
            false => Err(self.scanner.error(open, ErrorKind::Syntax, "`{` without a `}` after it")),
        }
    }

    /// Statements with semicolons between them, and `if`s that need none, up to an end or that of the script.
    fn statements(&mut self, nodes: &mut Vec<Node>, ends: fn(&Scanner<'_>) -> bool) -> Result<(), Error> {
        while !ends(&self.scanner) && self.scanner.token != Token::End {
            if self.scanner.skip_sign(";")? {
                continue;
            }
            if self.scanner.is_word("if") {
                let node = self.branches()?;
                nodes.push(node);
                continue;
            }
            let node = self.statement()?;
            if !ends(&self.scanner) && !self.scanner.is_sign(";") && self.scanner.token != Token::End {
                let near = match &node {
                    Node::Print(Expression { kind: Kind::Reference(reference), .. }) => {
                        nearest(&reference.name, KEYWORDS.iter().copied())
                    }
                    _ => None,
                };
                return Err(self.scanner.expected("`}`, `;` or an operator").with_near(near));
            }
            nodes.push(node);
        }
        Ok(())
    }

    /// An assignment, or an expression to be written.
    fn statement(&mut self) -> Result<Node, Error> {
        let scanner = &mut self.scanner;
        if let Token::Word(word @ ("local" | "global")) = scanner.token {
            scanner.advance()?;
            let (at, name) = name(scanner)?;
            scanner.need_sign("=")?;
            let target = Target::New { at, name, global: word == "global" };
            return Ok(Node::Assign(target, source(scanner)?));
        }
        if matches!(scanner.token, Token::Word(word) if !KEYWORDS.contains(&word)) {
            let mark = scanner.mark();
            let target = reference(scanner)?;
            if scanner.skip_sign("=")? {
                return Ok(Node::Assign(Target::Existing(target), source(scanner)?));
            }
            scanner.back(mark);
        }
        Ok(Node::Print(expression(scanner)?))
    }

    /// From `if` to after `endif`.
    fn branches(&mut self) -> Result<Node, Error> {
        let start = self.scanner.start;
        self.scanner.advance()?;
        let mut branches = Vec::new();
        loop {
            let condition = expression(&mut self.scanner)?;
            let mut nodes = Vec::new();
            if self.scanner.is_word("then") {
                self.scanner.advance()?;
                let ends =
                    |scanner: &Scanner<'_>| matches!(scanner.token, Token::Word("elsif" | "else" | "endif"));
                self.inner(start, &mut nodes, Some(ends))?;
            } else if self.scanner.is_sign("}") {
                self.inner(start, &mut nodes, None)?;
            } else {
                return Err(self.scanner.expected("`}`, `then` or an operator"));
            }
            branches.push((condition, nodes));
            if !self.scanner.is_word("elsif") {
                break;
            }
            self.scanner.advance()?;
        }
        let mut otherwise = Vec::new();
        if self.scanner.is_word("else") {
            self.scanner.advance()?;
            match self.scanner.is_sign("}") {
                true => self.inner(start, &mut otherwise, None)?,
                false => self.inner(start, &mut otherwise, Some(|scanner| scanner.is_word("endif")))?,
            }
        }
        if !self.scanner.is_word("endif") {
            return Err(self.scanner.expected("`endif`"));
        }
        self.scanner.advance()?;
        Ok(Node::If(branches, otherwise))
    }

    /// What belongs to a branch: statements up to an end, or text after the brace that is looked at.
    fn inner(
        &mut self,
        start: usize,
        nodes: &mut Vec<Node>,
        ends: Option<fn(&Scanner<'_>) -> bool>,
    ) -> Result<(), Error> {
        self.scanner.deeper()?;
        match ends {
            Some(ends) => self.statements(nodes, ends)?,
            None => drop(self.text(self.scanner.end, nodes)?),
        }
        self.scanner.shallower();
        match self.scanner.token {
            Token::Word("elsif" | "else" | "endif") => Ok(()),
            _ => Err(self.scanner.error(start, ErrorKind::Syntax, "`if` without an `endif` after it")),
        }
    }
}

/// What is assigned.
fn source(scanner: &mut Scanner<'_>) -> Result<Source, Error> {
    if scanner.is_word("repeat") {
        scanner.advance()?;
        scanner.need_sign("(")?;
        let count = expression(scanner)?;
        scanner.need_sign(",")?;
        let value = expression(scanner)?;
        scanner.need_sign(")")?;
        return Ok(Source::Repeat(count, value));
    }
    if scanner.is_sign("(") {
        // A list, unless an operator follows, before which it is an expression.
        let mark = scanner.mark();
        scanner.advance()?;
        let mut items = Vec::new();
        if !scanner.is_sign(")") {
            items.push(expression(scanner)?);
            while scanner.skip_sign(",")? {
                items.push(expression(scanner)?);
            }
        }
        scanner.need_sign(")")?;
        if matches!(
            scanner.token,
            Token::Sign(";" | "}") | Token::Word("elsif" | "else" | "endif") | Token::End
        ) {
            return Ok(Source::List(items));
        }
        scanner.back(mark);
    }
    Ok(Source::Value(expression(scanner)?))
}

fn push_text(nodes: &mut Vec<Node>, text: String) {
    if !text.is_empty() {
        nodes.push(Node::Text(text));
    }
}
