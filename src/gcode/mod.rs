//! Typed moves → bytes that a printer reads, and such bytes → moves again.
//!
//! Every layer is formatted by itself ([`format_layer`]) and concatenated between [`header()`] and [`footer()`].
//! Values known only when all layers are done have [`Slot`]s of fixed width, filled in before the file is
//! renamed.

mod effect;
mod extruder;
mod flavor;
mod header;
mod layer;
mod number;
mod options;
mod read;
mod script;
mod settings;
mod sizes;
mod slot;

use std::path::Path;

pub use effect::Effect;
pub(crate) use header::calendar;
pub use header::{Header, footer, header, labels, object_comment};
pub use layer::{LayerText, format_layer};
pub(crate) use number::{nearest, one_line, push_number};
pub use options::{Flavor, GcodeSettings, PrinterSettings};
pub use read::{
    Action, Annotated, Center, Clock, Code, Context, Line, Lines, Mark, Measure, Meter, Reader, Replay,
    State, Step, Stroke, Timetable, TypeMeasure, Words, annotate, each_line, file_time, lines, mark, measure,
    replay, role,
};
pub use script::Scripts;
pub use settings::{GcodeOptions, LayerScripts, ObjectLabel, PrintFacts, WriterSettings};
pub use sizes::thumbnail_sizes;
pub(crate) use slot::duration;
pub use slot::{Pending, Slot, Totals};

/// Endings of G-code files.
const ENDINGS: [&str; 6] = ["gcode", "gco", "gc", "g", "nc", "ngc"];

/// Whether a name is that of a G-code file.
pub fn is_gcode(path: &Path) -> bool {
    path.extension().is_some_and(|found| ENDINGS.iter().any(|ending| found.eq_ignore_ascii_case(ending)))
}
