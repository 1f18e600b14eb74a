//! The state that applies to a bead besides its own words: fan, accelerations, and type, width and height from
//! comments.

use super::slice::Slice;
use crate::gcode::{Line, Mark, mark};

/// Something that a line sets and that holds until the next such line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Key {
    /// `;TYPE:` and its like.
    Type,
    Width,
    Height,
    /// Cura's `;MESH:`.
    Mesh,
    /// M106 and M107 of one of four fans.
    Fan(u8),
    /// M204 S, which sets P and T as well.
    Acceleration,
    PrintAcceleration,
    TravelAcceleration,
    /// Klipper's SET_VELOCITY_LIMIT.
    VelocityLimit,
    CornerVelocity,
    Jerk,
    PressureAdvance,
}

/// Number of different keys.
const KEYS: usize = 15;
/// Keys that are comments come first.
const COMMENTS: usize = 4;
const ACCELERATIONS: std::ops::Range<usize> = 8..11;

impl Key {
    /// Its position among all.
    pub fn index(self) -> usize {
        match self {
            Key::Type => 0,
            Key::Width => 1,
            Key::Height => 2,
            Key::Mesh => 3,
            Key::Fan(fan) => 4 + usize::from(fan & 3),
            Key::Acceleration => 8,
            Key::PrintAcceleration => 9,
            Key::TravelAcceleration => 10,
            Key::VelocityLimit => 11,
            Key::CornerVelocity => 12,
            Key::Jerk => 13,
            Key::PressureAdvance => 14,
        }
    }

    /// Whether setting it makes another one void.
    pub fn replaces(self, other: Self) -> bool {
        self == Key::Acceleration && ACCELERATIONS.contains(&other.index())
    }

    /// The state that a line without motion sets; `None` if it sets none, or one that does not move with paths.
    pub fn of(line: &Line) -> Option<Self> {
        let Some(code) = line.code else { return Self::of_text(line) };
        if code.letter != b'M' {
            return None;
        }
        let words = line.words();
        let only = |letters: &[u8]| (b'A'..=b'Z').all(|l| letters.contains(&l) || words.get(l).is_none());
        match code.number {
            106 | 107 if only(b"SP") => {
                let fan = words.get(b'P').unwrap_or(0.0);
                [0.0, 1.0, 2.0, 3.0].iter().position(|n| *n == fan).map(|n| Key::Fan(n as u8))
            }
            204 if only(b"S") => Some(Key::Acceleration),
            204 if only(b"P") => Some(Key::PrintAcceleration),
            204 if only(b"T") => Some(Key::TravelAcceleration),
            205 | 566 if only(b"XY") => Some(Key::Jerk),
            572 if only(b"DS") => Some(Key::PressureAdvance),
            900 if only(b"K") => Some(Key::PressureAdvance),
            _ => None,
        }
    }

    /// Comments, and Klipper's commands with names.
    fn of_text(line: &Line) -> Option<Self> {
        let command = line.parameters().trim_ascii();
        if command.is_empty() {
            let comment = line.comment?;
            return match mark(comment) {
                Some(Mark::Feature(_)) => Some(Key::Type),
                Some(Mark::Width(_)) => Some(Key::Width),
                Some(Mark::Height(_)) => Some(Key::Height),
                None if comment.starts_with(b"MESH:") => Some(Key::Mesh),
                _ => None,
            };
        }
        let mut words = command.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        match words.next()? {
            b"SET_VELOCITY_LIMIT" => {
                let names: Vec<&[u8]> =
                    words.map(|word| word.split(|b| *b == b'=').next().unwrap_or(word)).collect();
                match names.as_slice() {
                    [b"SQUARE_CORNER_VELOCITY"] => Some(Key::CornerVelocity),
                    [b"ACCEL"] | [b"ACCEL", b"ACCEL_TO_DECEL"] => Some(Key::VelocityLimit),
                    _ => None,
                }
            }
            b"SET_PRESSURE_ADVANCE" => {
                let only = |word: &[u8]| word.starts_with(b"ADVANCE=") || word.starts_with(b"EXTRUDER=");
                words.all(only).then_some(Key::PressureAdvance)
            }
            _ => None,
        }
    }
}

/// The lines in force, by key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct States([Slice; KEYS]);

impl Default for States {
    fn default() -> Self {
        Self([Slice::default(); KEYS])
    }
}

impl States {
    /// Puts a line in force. Whether there was one before: if not, what went before it cannot be restored.
    pub fn set(&mut self, key: Key, line: Slice) -> bool {
        let known = !self.0[key.index()].is_empty();
        if key == Key::Acceleration {
            ACCELERATIONS.for_each(|index| self.0[index] = Slice::default());
        }
        self.0[key.index()] = line;
        known
    }

    /// The line in force.
    pub fn get(&self, key: Key) -> Slice {
        self.0[key.index()]
    }

    /// The lines that lead from one state to another; with `comments` also those that say something only.
    pub fn changes<'t>(&self, to: &States, comments: bool, text: &'t [u8]) -> impl Iterator<Item = &'t [u8]> {
        let differs = |index: usize| self.0[index].of(text) != to.0[index].of(text);
        let accelerations = ACCELERATIONS.into_iter().any(differs);
        let said = move |index: &usize| comments || *index >= COMMENTS;
        let indices: Vec<usize> = (0..KEYS)
            .filter(said)
            .filter(|&index| differs(index) || accelerations && ACCELERATIONS.contains(&index))
            .collect();
        let to = *to;
        indices.into_iter().map(move |index| to.0[index].of(text)).filter(|line| !line.is_empty())
    }

    /// Takes the commands, but not the comments, from another state.
    pub fn with_commands_of(mut self, other: &States) -> Self {
        self.0[COMMENTS..].copy_from_slice(&other.0[COMMENTS..]);
        self
    }

    /// All lines, for moving them to another text.
    pub fn slices_mut(&mut self) -> impl Iterator<Item = &mut Slice> {
        self.0.iter_mut()
    }
}
