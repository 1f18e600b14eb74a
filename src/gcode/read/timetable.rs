//! The time of a file of any size, by role and by layer.

use std::io::{self, Read};

use super::annotate::Reader;
use super::lexer::Line;
use super::replay::{Action, Stroke};
use super::stream::each_line;
use super::time::Clock;
use crate::estimate::Machine;
use crate::toolpath::Role;

const TRAVEL: usize = 0;
const RETRACTION: usize = 1;
const WAIT: usize = 2;
const CHANGE: usize = 3;
/// Extrusion of which the file does not say what it is for.
const UNKNOWN: usize = 4;
const ROLES: usize = 5;
/// Accounts of a layer.
const ACCOUNTS: usize = ROLES + Role::ALL.len();

/// How long a file takes, and where the time goes. Homing and pauses take none, heating only after a change of tool.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Timetable {
    /// Before the first layer, then layer by layer.
    spans: Vec<[f64; ACCOUNTS]>,
    /// Height of each layer.
    z_mm: Vec<f64>,
}

impl Timetable {
    /// Reads a file line by line, in memory that does not grow with it but for some numbers on each layer.
    ///
    /// # Errors
    /// Those of reading.
    pub fn read(file: impl Read, machine: &Machine) -> io::Result<Self> {
        let mut reading = Reading::new(machine);
        each_line(file, |line| reading.line(line))?;
        Ok(reading.finish())
    }

    /// All of it, seconds.
    pub fn total_s(&self) -> f64 {
        self.spans.iter().flatten().sum()
    }

    /// Seconds before the first layer.
    pub fn before_s(&self) -> f64 {
        self.spans.first().map_or(0.0, |span| span.iter().sum())
    }

    /// Number of layers.
    pub fn layers(&self) -> usize {
        self.z_mm.len()
    }

    /// Height of a layer, its seconds, and what they are spent on: those of [`roles`](Self::roles).
    pub fn layer(&self, index: usize) -> (f64, f64, Vec<(&'static str, f64)>) {
        let span = self.spans.get(index + 1).unwrap_or(&[0.0; ACCOUNTS]);
        (self.z_mm[index], span.iter().sum(), named(span))
    }

    /// Seconds of the whole file by role or activity, without those of none.
    pub fn roles(&self) -> Vec<(&'static str, f64)> {
        let mut sums = [0.0; ACCOUNTS];
        for span in &self.spans {
            for (sum, seconds) in sums.iter_mut().zip(span) {
                *sum += seconds;
            }
        }
        named(&sums)
    }
}

/// What takes any time, by the names that viewers know. Skirt and brim have one.
fn named(accounts: &[f64; ACCOUNTS]) -> Vec<(&'static str, f64)> {
    let names = ["Travel", "Retraction", "Wait", "Tool change", "Unknown"].into_iter();
    let mut out: Vec<(&str, f64)> = Vec::new();
    for (name, seconds) in names.chain(Role::ALL.map(Role::type_name)).zip(*accounts) {
        match out.last_mut() {
            Some((last, sum)) if *last == name => *sum += seconds,
            _ if seconds > 0.0 => out.push((name, seconds)),
            _ => {}
        }
    }
    out
}

struct Reading {
    reader: Reader,
    clock: Clock,
    z_mm: Vec<f64>,
}

impl Reading {
    fn new(machine: &Machine) -> Self {
        Self { reader: Reader::default(), clock: Clock::new(machine), z_mm: Vec::new() }
    }

    fn line(&mut self, line: Line<'_>) {
        let read = self.reader.read(line);
        let kind = match &read.action {
            Action::Stroke(stroke) if stroke.extrudes() => {
                self.extrude(stroke, read.context.layer);
                read.context.role.map_or(UNKNOWN, |role| ROLES + role as usize)
            }
            Action::Stroke(stroke) if stroke.xy_mm > 1e-9 || stroke.from[2] != stroke.to[2] => TRAVEL,
            Action::Stroke(_) | Action::FirmwareRetract | Action::FirmwareUnretract => RETRACTION,
            _ if read.line.code.is_some_and(|code| code.letter == b'T') => CHANGE,
            _ => WAIT,
        };
        let span = read.context.layer.map_or(0, |layer| layer + 1);
        self.clock.step(&read.line, &read.action, span * ACCOUNTS + kind);
    }

    /// Notes the height of a layer's first bead.
    fn extrude(&mut self, stroke: &Stroke, layer: Option<usize>) {
        if layer.is_some_and(|layer| layer == self.z_mm.len()) {
            self.z_mm.push(stroke.to[2]);
        }
    }

    fn finish(self) -> Timetable {
        let seconds = self.clock.finish();
        let mut spans: Vec<[f64; ACCOUNTS]> = seconds
            .chunks(ACCOUNTS)
            .map(|chunk| std::array::from_fn(|i| chunk.get(i).copied().unwrap_or(0.0)))
            .collect();
        spans.resize(self.z_mm.len() + 1, [0.0; ACCOUNTS]);
        Timetable { spans, z_mm: self.z_mm }
    }
}
