//! Reads finished G-code of any slicer and finds its faults.
//!
//! The reading is independent of how the program writes: of `gcode` it uses the reader of lines and the machine's
//! state. Each family of rules is a file; a [`FaultFinder`] hands every line to all of them, and what they find is
//! grouped by kind; a [`Checker`] reads by itself. Memory does not grow with the file. [`against`] goes
//! over a file again beside its model.

mod bed;
mod beside;
mod fault;
mod filament;
mod floating;
mod flush;
mod heat;
mod heights;
mod limits;
mod material;
mod model;
mod moves;
mod precision;
mod relief;
mod report;
mod rule;
mod tools;
mod words;

use std::io::{self, Read};

pub use beside::{ModelReport, PlacedBody};
pub use fault::{Kind, Severity};
pub use model::{Survey, against};
pub use report::{CheckReport, Fault, Found, Location};

use crate::estimate::Machine;
use crate::gcode::{Action, Annotated, Clock, Line, Meter, Reader, State, Stroke, each_line, lines};
use crate::profile::Settings;
use crate::report::Measures;
use crate::units::Seconds;
use rule::{LineContext, Rule};

/// Follows a file, line by line.
pub struct Checker {
    reader: Reader,
    finder: FaultFinder,
    lines: usize,
    bytes: usize,
}

/// Finds faults in lines that have been read.
pub struct FaultFinder {
    rules: Vec<Box<dyn Rule>>,
    found: Found,
    /// Whether scripts are looked at as well; if not, what they do wrong is recorded separately.
    scripts: bool,
    aside: Found,
    begun: bool,
    /// Whether what follows is marked as a script's.
    in_script: bool,
    located: bool,
    /// What G92 has moved the file's zero by.
    zero_mm: [f64; 3],
    /// Axes that are at the end where Makerbot's commands home them, of which G92 says where that is.
    at_end: [bool; 3],
    /// Where each tool's nozzle is, seen from the first one's, and that of the tool in use.
    offsets_mm: Vec<[f64; 2]>,
    offset_mm: [f64; 2],
    /// The machine as the line before left it.
    position: [f64; 3],
    retracted_mm: f64,
    firmware_retracted: bool,
    is_retracted: bool,
    moves: usize,
    layers: usize,
}

impl Checker {
    /// A checker for files for a printer.
    pub fn new(settings: &Settings) -> Self {
        let mut finder = FaultFinder::of_paths(settings, true);
        finder.rules.push(Box::new(floating::Floating::new(settings)));
        finder.rules.push(Box::new(flush::Flush::new(settings)));
        finder.rules.push(Box::new(heat::Heat::default()));
        finder.rules.push(Box::new(limits::Limits::new(settings)));
        finder.rules.push(Box::new(tools::Tools::new(settings)));
        finder.rules.push(Box::new(precision::Precision::default()));
        Self::with(finder)
    }

    /// A checker that passes the lines it reads to `finder`.
    pub fn with(finder: FaultFinder) -> Self {
        Self { reader: Reader::default(), finder, lines: 0, bytes: 0 }
    }

    /// Forgets any retraction so far, as one that a script leaves behind is intended.
    pub fn forget_retraction(&mut self) {
        self.reader.state.retracted_mm = 0.0;
        self.reader.state.firmware_retracted = false;
        self.finder.retracted_mm = 0.0;
        (self.finder.firmware_retracted, self.finder.is_retracted) = (false, false);
    }

    /// Takes the lines of a text, which continues where the last one ended. It ends with a whole line.
    pub fn text(&mut self, text: &[u8]) {
        for line in lines(text) {
            self.line(line.placed(self.lines + 1, self.bytes));
        }
    }

    /// Processes a line. Returns it with what it does.
    pub fn line<'a>(&mut self, line: Line<'a>) -> Annotated<'a> {
        self.lines += 1;
        self.bytes += line.raw.len();
        let mut read = self.reader.read(line);
        let was_script = self.finder.in_script;
        self.finder.check_line(&mut read, &self.reader.state);
        if was_script && !self.finder.in_script {
            self.forget_retraction();
        }
        read
    }

    /// Moves so far. A file without any is no G-code.
    pub fn moves(&self) -> usize {
        self.finder.moves
    }

    /// The file is at its end.
    pub fn finish(self) -> Found {
        self.finder.finish()
    }
}

impl FaultFinder {
    /// Looks for errors in paths only; without `scripts` only in paths whose role is known.
    pub fn of_paths(settings: &Settings, scripts: bool) -> Self {
        Self {
            rules: vec![
                Box::new(words::Words),
                Box::new(bed::Bed::new(settings)),
                Box::new(filament::Filament::new(settings)),
                Box::new(heights::Heights::new(settings)),
                Box::new(material::Material::new(settings)),
            ],
            found: Found::default(),
            scripts,
            aside: Found::default(),
            begun: false,
            in_script: false,
            located: false,
            zero_mm: [0.0; 3],
            at_end: [false; 3],
            offsets_mm: (0..settings.tools.len())
                .map(|tool| settings.of_tool(tool).tool.offset.map(|mm| mm.0))
                .collect(),
            offset_mm: [0.0; 2],
            position: [0.0; 3],
            retracted_mm: 0.0,
            firmware_retracted: false,
            is_retracted: false,
            moves: 0,
            layers: 0,
        }
    }

    /// Processes a line; `state`: what the machine has in mind after it. Its move is put where the machine makes it,
    /// whatever G92 calls places.
    pub fn check_line(&mut self, read: &mut Annotated<'_>, state: &State) {
        self.follow_zero(&read.line, state.position);
        if let Some(name) = read.line.comment.and_then(type_name) {
            self.in_script = name == b"Custom";
        }
        self.judge(read, state);
    }

    /// The same of a line that does nothing but what its action is.
    fn judge(&mut self, read: &mut Annotated<'_>, state: &State) {
        self.position = state.position;
        let retracted_mm = std::mem::replace(&mut self.retracted_mm, state.retracted_mm);
        let firmware_retracted = std::mem::replace(&mut self.firmware_retracted, state.firmware_retracted);
        let is_retracted = std::mem::replace(&mut self.is_retracted, state.is_retracted());
        if let Action::Stroke(stroke) = &mut read.action {
            let [x, y, z] = self.zero_mm;
            let by_mm = [x + self.offset_mm[0], y + self.offset_mm[1], z];
            if by_mm != [0.0; 3] {
                *stroke = moved(*stroke, by_mm);
            }
            self.moves += 1;
            self.begun |= stroke.extrudes();
            if stroke.extrudes() {
                self.layers = self.layers.max(read.context.layer.map_or(0, |layer| layer + 1));
            }
        }
        let seen = LineContext {
            line: &read.line,
            action: &read.action,
            context: &read.context,
            state,
            retracted_mm,
            firmware_retracted,
            is_retracted,
            begun: self.begun,
            in_script: self.in_script,
            located: self.located,
        };
        let judged = self.scripts || read.context.role.is_some();
        let found = if judged { &mut self.found } else { &mut self.aside };
        for rule in &mut self.rules {
            rule.check_line(&seen, found);
        }
        if matches!(read.action, Action::Stroke(stroke) if stroke.xy_mm > 0.0) {
            self.located = true;
        }
    }

    /// G92 gives positions other names; homing gives them their own again, or (G161, G162) leaves it to G92 to name them.
    fn follow_zero(&mut self, line: &Line<'_>, position: [f64; 3]) {
        if let Some(code) = line.code.filter(|code| code.letter == b'T') {
            let offset_mm = self.offsets_mm.get(code.number as usize).copied();
            self.offset_mm = offset_mm.unwrap_or(self.offset_mm);
        }
        if line.is(b'G', 92) {
            for (axis, letter) in b"XYZ".iter().enumerate() {
                if self.at_end[axis] && line.names(*letter) {
                    (self.zero_mm[axis], self.at_end[axis]) = (0.0, false);
                } else {
                    self.zero_mm[axis] += self.position[axis] - position[axis];
                }
            }
        } else if line.is(b'G', 28) {
            self.located = false;
            let all = !b"XYZ".iter().any(|letter| line.names(*letter));
            for (zero, letter) in self.zero_mm.iter_mut().zip(*b"XYZ") {
                *zero = if all || line.names(letter) { 0.0 } else { *zero };
            }
        } else if line.is(b'G', 161) || line.is(b'G', 162) {
            for (at_end, letter) in self.at_end.iter_mut().zip(*b"XYZ") {
                *at_end |= line.names(letter);
            }
        }
    }

    /// The file is at its end.
    pub fn finish(mut self) -> Found {
        for rule in &mut self.rules {
            rule.end(&mut self.found);
        }
        self.found
    }
}

/// What a comment says that follows, as PrusaSlicer, OrcaSlicer and Bambu Studio mark it.
fn type_name(comment: &[u8]) -> Option<&[u8]> {
    let comment = comment.trim_ascii();
    let name = comment.strip_prefix(b"TYPE:").or_else(|| comment.strip_prefix(b"FEATURE:"))?;
    Some(name.trim_ascii())
}

/// A move in a frame that lies elsewhere.
fn moved(mut stroke: Stroke, by_mm: [f64; 3]) -> Stroke {
    for (axis, by_mm) in by_mm.into_iter().enumerate() {
        stroke.from[axis] += by_mm;
        stroke.to[axis] += by_mm;
        if let Some(center) = stroke.arc.as_mut().filter(|_| axis < 2) {
            center.at[axis] += by_mm;
        }
    }
    stroke
}

/// Reads a file once and reports its faults for a printer; `None` if there is no move in it. What the file prints is
/// noted in the survey, for [`against`].
///
/// # Errors
/// Those of reading.
pub fn check(
    file: impl Read,
    settings: &Settings,
    mut survey: Option<&mut Survey>,
) -> io::Result<Option<CheckReport>> {
    let machine = Machine::new(settings);
    let mut checker = Checker::new(settings);
    let mut meter = Meter::new(settings.filament.diameter, None);
    let mut clock = Clock::new(&machine);
    each_line(file, |line| {
        let read = checker.line(line);
        meter.add(&read.action);
        clock.step(&read.line, &read.action, 0);
        if let Some(survey) = &mut survey {
            survey.add(&read);
        }
    })?;
    if checker.moves() == 0 {
        return Ok(None);
    }
    let measure = meter.finish();
    let mut report = CheckReport {
        lines: checker.lines,
        layer_count: checker.finder.layers,
        total: Measures::of(&measure, Seconds(clock.finish().iter().sum()), machine.filament_area_mm2),
        ..CheckReport::default()
    };
    report.extend(checker.finish());
    Ok(Some(report))
}
