//! G-code back to what it makes the machine do.
//!
//! [`lines`] takes the text apart, [`Replay`] follows it as a machine would (positions, modes, filament), and
//! [`measure`] sums up lengths and volumes. Nothing fails: what is not understood is passed on as it is.

mod lexer;
mod measure;
mod replay;
mod time;

pub use lexer::{Code, Line, Lines, Words, lines};
pub use measure::{Measure, TypeMeasure, measure, measure_on};
pub use replay::{Action, Center, Replay, Step, Stroke, replay, resume};
pub use time::{Clock, file_time, time_on};
