//! Typed moves → bytes that a printer reads, and such bytes → moves again.
//!
//! Every layer is formatted by itself ([`format_layer`]) and concatenated between [`header()`] and [`footer()`].
//! Values known only when all layers are done have [`Slot`]s of fixed width, filled in before the file is
//! renamed.

mod binary;
mod effect;
mod extruder;
mod file;
mod flavor;
mod form;
mod header;
mod layer;
mod number;
mod options;
mod package;
mod read;
mod script;
mod settings;
mod slot;
mod thumbnails;
mod tool;

pub use binary::{BinaryMetadata, write_binary};
#[cfg(feature = "cli")]
pub(crate) use binary::{contents, pack_text};
pub use effect::Effect;
pub(crate) use effect::script_time;
#[cfg(feature = "cli")]
pub(crate) use file::open_stream;
pub(crate) use file::{Input, open, open_bytes};
pub use form::{Form, is_gcode};
pub(crate) use header::calendar;
pub use header::{Header, footer, header, labels, object_comment};
pub use layer::{LayerText, format_layer};
pub(crate) use number::{nearest, one_line, push_number};
pub use options::{Flavor, GcodeSettings, PrinterSettings, ToolChangeKind, ToolChangeSettings, ToolSettings};
#[cfg(feature = "cli")]
pub(crate) use package::{Parts, write as write_package};
pub(crate) use read::NO_TOOL;
pub use read::{
    Action, Annotated, Center, Clock, Code, Context, Line, Lines, Mark, Measure, Meter, Reader, Replay,
    State, Step, Stroke, Timetable, TypeMeasure, Words, annotate, each_line, file_time, lines, mark, measure,
    replay, role,
};
pub use script::Scripts;
pub(crate) use script::{sets_pressure_advance, takes_tool};
pub(crate) use settings::BEFORE_LAYER_CHANGE;
pub use settings::{
    GcodeOptions, LayerScripts, ObjectLabel, PrintFacts, ToolFacts, ToolOptions, ToolWriter, WriterSettings,
};
pub(crate) use slot::duration;
pub use slot::{Pending, Slot, Totals};
pub use thumbnails::{ThumbnailFormat, ThumbnailSpec, thumbnail_list};
pub use tool::ToolMark;
pub(crate) use tool::preheating;
