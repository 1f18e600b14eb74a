//! G-code back to what it makes the machine do.
//!
//! [`lines`] takes the text apart, [`State`] follows it as a machine would (positions, modes, filament), line by line or
//! over a whole text ([`replay`]). [`annotate`] adds what slicers say in comments: what a stroke is for and to which
//! layer it belongs. [`measure`] sums up lengths and volumes. Nothing fails: what is not understood is passed on as it is.

mod annotate;
mod changes;
mod features;
mod lexer;
mod limits;
mod marks;
mod measure;
mod replay;
mod stream;
mod time;
mod timetable;

pub use annotate::{Annotated, Context, Reader, annotate};
pub use features::role;
pub use lexer::{Code, Line, Lines, Words, lines};
pub use marks::{Mark, mark};
pub use measure::{Measure, Meter, TypeMeasure, measure, measure_on};
pub(crate) use replay::NO_TOOL;
pub use replay::{Action, Center, Replay, State, Step, Stroke, replay, resume};
pub use stream::each_line;
pub use time::{Clock, file_time, time_on};
pub use timetable::Timetable;
