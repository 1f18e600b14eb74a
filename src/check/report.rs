//! Faults, gathered: the same fault many times over is one entry.

use std::fmt;

use serde::{Serialize, Serializer};

use super::beside::ModelReport;
use super::fault::{Kind, Severity};
use crate::report::Measures;

/// Number of locations kept of each kind of fault.
const KEPT: usize = 5;
/// Number of them shown to people.
const SHOWN: usize = 3;

/// Where a fault is.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Location {
    /// Line of the file, from 1.
    pub line: usize,
    /// Layer, from 1; nothing before the first.
    pub layer: Option<usize>,
    /// What exactly.
    pub detail: String,
}

/// All faults of one kind.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fault {
    /// What it is.
    #[serde(serialize_with = "kind_name")]
    pub kind: Kind,
    /// How bad it is.
    pub severity: Severity,
    /// How often it was found.
    pub count: usize,
    /// The first few locations.
    pub first: Vec<Location>,
}

fn kind_name<S: Serializer>(kind: &Kind, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(kind.name())
}

/// Collects faults; memory does not grow with their number.
#[derive(Clone, Debug, Default)]
pub struct Found {
    faults: Vec<Fault>,
}

impl Found {
    /// Adds a fault. The detail is made only where it is kept.
    pub fn add(&mut self, kind: Kind, line: usize, layer: Option<usize>, detail: impl FnOnce() -> String) {
        let at = self.faults.iter().position(|fault| fault.kind == kind).unwrap_or_else(|| {
            let severity = kind.severity();
            self.faults.push(Fault { kind, severity, count: 0, first: Vec::new() });
            self.faults.len() - 1
        });
        let fault = &mut self.faults[at];
        fault.count += 1;
        if fault.first.len() < KEPT {
            fault.first.push(Location { line, layer: layer.map(|index| index + 1), detail: detail() });
        }
    }

    /// Everything found, the worst first.
    pub fn into_faults(mut self) -> Vec<Fault> {
        self.faults.sort_by_key(|fault| (std::cmp::Reverse(fault.severity), fault.kind));
        self.faults
    }

    /// The first fault of a path that is of another kind than those of another file; nothing if there is none.
    pub fn first_of_paths(&self, but: &Found) -> Option<(Kind, Location)> {
        let known = |kind: Kind| but.faults.iter().any(|fault| fault.kind == kind);
        let faults = self.faults.iter().filter(|fault| fault.kind.is_of_paths() && !known(fault.kind));
        let first = faults.min_by_key(|fault| fault.first.first().map_or(0, |location| location.line))?;
        Some((first.kind, first.first.first()?.clone()))
    }
}

/// The faults of a file. `Display` gives the table for people, `Serialize` the JSON.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct CheckReport {
    /// The file, as named on the command line.
    pub file: String,
    /// Number of kinds of faults that are errors.
    pub errors: usize,
    /// As many that are warnings.
    pub warnings: usize,
    /// As many that are notes.
    pub notes: usize,
    /// The faults, the worst first.
    pub faults: Vec<Fault>,
    /// Lines read.
    pub lines: usize,
    /// Layers with beads.
    pub layer_count: usize,
    /// Lengths, counts and volume.
    #[serde(flatten)]
    pub total: Measures,
    /// How the print compares to the model.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub model: Option<ModelReport>,
}

impl CheckReport {
    /// Adds the faults of another report of the same file whose kinds are not in this one.
    pub fn join(&mut self, other: CheckReport) {
        self.extend(Found { faults: other.faults });
        self.model = self.model.take().or(other.model);
    }

    /// Adds faults, of other kinds than there are.
    pub(super) fn extend(&mut self, found: Found) {
        let all = self.faults.drain(..).chain(found.faults).collect();
        self.faults = Found { faults: all }.into_faults();
        let count = |severity| self.faults.iter().filter(|fault| fault.severity == severity).count();
        (self.errors, self.warnings) = (count(Severity::Error), count(Severity::Warning));
        self.notes = count(Severity::Note);
    }
}

impl fmt::Display for CheckReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { file, lines, layer_count, total, .. } = self;
        writeln!(f, "{file}: {lines} lines, {layer_count} layers, {:.2} m printed", total.print_mm / 1000.0)?;
        for fault in &self.faults {
            let Fault { kind, severity, count, first } = fault;
            writeln!(f, "  {:<8} {:<22} {count:>7}  {}", severity.name(), kind.name(), kind.text())?;
            for location in first.iter().take(SHOWN) {
                let layer = location.layer.map_or(String::new(), |layer| format!(", layer {layer}"));
                writeln!(f, "  {:8} {:22} line {}{layer}: {}", "", "", location.line, location.detail)?;
            }
        }
        if let Some(model) = &self.model {
            write!(f, "{model}")?;
        }
        match (self.errors, self.warnings, self.notes) {
            (0, 0, 0) => writeln!(f, "  nothing wrong was found"),
            (errors, warnings, notes) => {
                writeln!(f, "  kinds of faults: {errors} errors, {warnings} warnings, {notes} notes")
            }
        }
    }
}
