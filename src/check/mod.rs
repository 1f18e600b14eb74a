//! Reads finished G-code, of any slicer, and tells what is wrong with it.
//!
//! The reading is independent of how the program writes: of `gcode` it uses the reader of lines and the machine's
//! state. Each family of rules is a file; a [`Checker`] hands every line to all of them, and what they find is
//! grouped by kind. Memory does not grow with the file. [`against`] goes over a file again beside its model.

mod bed;
mod fault;
mod filament;
mod heat;
mod heights;
mod limits;
mod material;
mod model;
mod precision;
mod relief;
mod report;
mod rule;
mod words;

use std::io::{self, Read};

pub use fault::{Kind, Severity};
pub use model::{ModelReport, Survey, against};
pub use report::{CheckReport, Fault, Found, Place};

use crate::estimate::Machine;
use crate::gcode::{Action, Annotated, Clock, Line, Meter, Reader, Stroke, each_line, lines};
use crate::profile::Settings;
use crate::report::Measures;
use crate::units::Seconds;
use rule::{Rule, Seen};

/// Follows a file, line by line.
pub struct Checker {
    reader: Reader,
    rules: Vec<Box<dyn Rule>>,
    found: Found,
    /// Whether scripts are looked at as well; if not, what they do wrong is put aside.
    scripts: bool,
    aside: Found,
    begun: bool,
    located: bool,
    /// What G92 has moved the file's zero by.
    zero_mm: [f64; 3],
    lines: usize,
    bytes: usize,
    moves: usize,
    layers: usize,
}

impl Checker {
    /// A checker for files for a printer.
    pub fn new(settings: &Settings) -> Self {
        let mut checker = Self::of_paths(settings, true);
        checker.rules.push(Box::new(heat::Heat::default()));
        checker.rules.push(Box::new(limits::Limits::new(settings)));
        checker.rules.push(Box::new(precision::Precision::default()));
        checker
    }

    /// A checker that looks for errors in paths only. Without `scripts` it looks only at what is of a role that is known.
    pub fn of_paths(settings: &Settings, scripts: bool) -> Self {
        Self {
            reader: Reader::default(),
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
            located: false,
            zero_mm: [0.0; 3],
            lines: 0,
            bytes: 0,
            moves: 0,
            layers: 0,
        }
    }

    /// Forgets what filament has been pulled back: what a script leaves behind is its own affair.
    pub fn pardon(&mut self) {
        self.reader.state.retracted_mm = 0.0;
        self.reader.state.firmware_retracted = false;
    }

    /// Takes up the lines of a text, which goes on where the last one ended. It ends with a whole line.
    pub fn text(&mut self, text: &[u8]) {
        for line in lines(text) {
            self.line(Line::new(self.lines + 1, self.bytes, line.raw));
        }
    }

    /// Takes up a line. Returns it with what it does.
    pub fn line<'a>(&mut self, line: Line<'a>) -> Annotated<'a> {
        self.lines += 1;
        self.bytes += line.raw.len();
        let (before, firmware_retracted) = (self.reader.state.position, self.reader.state.firmware_retracted);
        let retracted_mm = self.reader.state.retracted_mm;
        let read = self.reader.read(line);
        self.follow_zero(&line, before);
        let action = match read.action {
            Action::Stroke(stroke) => Action::Stroke(moved(stroke, self.zero_mm)),
            action => action,
        };
        if let Action::Stroke(stroke) = &action {
            self.moves += 1;
            self.begun |= stroke.extrudes();
            if stroke.extrudes() {
                self.layers = self.layers.max(read.context.layer.map_or(0, |layer| layer + 1));
            }
        }
        let seen = Seen {
            line: &line,
            action: &action,
            context: read.context,
            state: &self.reader.state,
            retracted_mm,
            firmware_retracted,
            begun: self.begun,
            located: self.located,
        };
        let judged = self.scripts || read.context.role.is_some();
        let found = if judged { &mut self.found } else { &mut self.aside };
        for rule in &mut self.rules {
            rule.see(&seen, found);
        }
        if matches!(action, Action::Stroke(stroke) if stroke.xy_mm > 0.0) {
            self.located = true;
        }
        Annotated { action, ..read }
    }

    /// G92 gives places other names; homing gives them their own again.
    fn follow_zero(&mut self, line: &Line<'_>, before: [f64; 3]) {
        if line.is(b'G', 92) {
            for (axis, zero) in self.zero_mm.iter_mut().enumerate() {
                *zero += before[axis] - self.reader.state.position[axis];
            }
        } else if line.is(b'G', 28) {
            self.located = false;
            let named = |letter: u8| line.parameters().to_ascii_uppercase().contains(&letter);
            let all = !b"XYZ".iter().any(|letter| named(*letter));
            for (zero, letter) in self.zero_mm.iter_mut().zip(*b"XYZ") {
                *zero = if all || named(letter) { 0.0 } else { *zero };
            }
        }
    }

    /// Moves so far. A file without any is no G-code.
    pub fn moves(&self) -> usize {
        self.moves
    }

    /// The file is at its end.
    pub fn finish(mut self) -> Found {
        for rule in &mut self.rules {
            rule.end(&mut self.found);
        }
        self.found
    }
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

/// Reads a file for a printer once and reports what is wrong with it; `None` if there is no move in it. What the file
/// prints is noted in the survey, for [`against`].
///
/// # Errors
/// Those of reading.
pub fn check(file: impl Read, settings: &Settings, survey: &mut Survey) -> io::Result<Option<CheckReport>> {
    let machine = Machine::new(settings);
    let mut checker = Checker::new(settings);
    let mut meter = Meter::new(settings.filament.diameter, None);
    let mut clock = Clock::new(&machine);
    each_line(file, |line| {
        let read = checker.line(line);
        meter.add(&read.action);
        clock.step(&read.line, &read.action, 0);
        survey.add(&read);
    })?;
    if checker.moves() == 0 {
        return Ok(None);
    }
    let measure = meter.finish();
    let mut report = CheckReport {
        lines: checker.lines,
        layer_count: checker.layers,
        total: Measures::of(&measure, Seconds(clock.finish().iter().sum()), machine.filament_area_mm2),
        ..CheckReport::default()
    };
    report.extend(checker.finish());
    Ok(Some(report))
}
