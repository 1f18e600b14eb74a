//! The trait of rules, and the lines that they check.

use super::fault::Kind;
use super::report::Found;
use crate::gcode::{Action, Context, Line, State, Stroke};

/// A line, what it does, and the state of the machine before it. Positions are the machine's, whatever G92 calls them.
pub(super) struct LineContext<'a> {
    pub line: &'a Line<'a>,
    pub action: &'a Action<'a>,
    pub context: &'a Context,
    /// After the line.
    pub state: &'a State,
    /// Filament retracted before the line, mm.
    pub retracted_mm: f64,
    /// Whether it was retracted by G10 before the line.
    pub firmware_retracted: bool,
    /// Whether it was retracted before the line, and not just [pushed forward less](State::is_retracted).
    pub is_retracted: bool,
    /// Whether a bead has been printed before or by this line.
    pub begun: bool,
    /// Whether the line is marked as a script's, which may purge beside the bed, in place and faster than a bead.
    pub in_script: bool,
    /// Whether the position that a move starts from is known: it is not after some axes have been homed.
    pub located: bool,
}

impl<'a> LineContext<'a> {
    /// The move, if it is one.
    pub fn stroke(&self) -> Option<&'a Stroke> {
        match self.action {
            Action::Stroke(stroke) => Some(stroke),
            _ => None,
        }
    }

    /// The move, if it extrudes a bead.
    pub fn bead(&self) -> Option<&'a Stroke> {
        self.stroke().filter(|stroke| stroke.extrudes())
    }

    /// Whether the line is a macro, whose effect is unknown.
    pub fn named(&self) -> Option<&'a [u8]> {
        let text = self.line.parameters().trim_ascii();
        let name = text.split(u8::is_ascii_whitespace).next().unwrap_or_default();
        let letters = name.len() > 1 && name.iter().take(2).all(|b| b.is_ascii_alphabetic() || *b == b'_');
        (self.line.code.is_none() && letters).then_some(name)
    }

    /// Whether the line says that printing continues with another object, which may stand on the bed.
    pub fn another_object(&self) -> bool {
        if let Some(code) = self.line.code {
            return (code.letter, code.number) == (b'M', 486);
        }
        let comment = self.line.comment.unwrap_or_default().trim_ascii();
        comment.starts_with(b"printing object")
            || comment.starts_with(b"MESH:")
            || self.named().is_some_and(|name| name.eq_ignore_ascii_case(b"EXCLUDE_OBJECT_START"))
    }

    /// Reports a fault of this line.
    pub fn fault(&self, found: &mut Found, kind: Kind, detail: impl FnOnce() -> String) {
        found.add(kind, self.line.number, self.context.layer, detail);
    }

    /// The command, for messages.
    pub fn text(&self) -> String {
        let text = self.line.text.split(|b| *b == b';').next().unwrap_or_default();
        String::from_utf8_lossy(text).trim().chars().take(60).collect()
    }
}

/// A family of rules. It follows the file line by line in memory that does not grow with it.
pub(super) trait Rule: Send {
    /// Processes a line.
    fn check_line(&mut self, seen: &LineContext<'_>, found: &mut Found);

    /// The file is at its end.
    fn end(&mut self, _found: &mut Found) {}
}
