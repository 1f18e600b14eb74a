//! How a run can fail: what is wrong, and where.

use std::io;

use crate::check::{Kind, Location};
use crate::mesh::MeshError;
use crate::output::OutputError;
use crate::plate::PlacementError;
use crate::profile::ProfileError;

/// Why a run gave no result. Each message names the location and the remedy.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum JobError {
    /// A model cannot be read, or not be used as it is.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// There is nothing to print, or G-code cannot be read.
    #[error(transparent)]
    Input(#[from] InputError),
    /// Settings that this job cannot be done with.
    #[error(transparent)]
    Settings(#[from] ProfileError),
    /// A script of the profile has mistakes.
    #[error("{}", mistakes.join("\n"))]
    Script {
        /// Each with its script and line.
        mistakes: Vec<String>,
    },
    /// The models do not fit the printer.
    #[error(transparent)]
    DoesNotFit(#[from] FitError),
    /// The G-code cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The result failed a check of its own; nothing is written.
    #[error(transparent)]
    Check(#[from] CheckError),
    /// The run was cancelled.
    #[error("cancelled")]
    Cancelled,
}

impl JobError {
    /// What kind of error it is, in a word for programs.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Mesh(_) | Self::Input(_) => "input",
            Self::Settings(_) | Self::Script { .. } => "settings",
            Self::DoesNotFit(_) => "does_not_fit",
            Self::Output(_) => "output",
            Self::Check(_) => "check",
            Self::Cancelled => "cancelled",
        }
    }

    /// The same with sizes of models that point to another unit, where that may be the cause.
    pub(crate) fn hinting(mut self, more: &[String]) -> Self {
        if let Self::Check(CheckError::InMidAir { hints, .. })
        | Self::Input(InputError::SpiralEnds { hints, .. }) = &mut self
        {
            hints.extend_from_slice(more);
        }
        self
    }

    /// The object that is at fault, if it is one.
    pub fn object(&self) -> Option<&str> {
        match self {
            Self::Input(InputError::TooThin { object, .. })
            | Self::DoesNotFit(FitError::Gantry { object, .. })
            | Self::Check(CheckError::InMidAir { object, .. }) => Some(object),
            Self::DoesNotFit(FitError::Placement { source, .. }) => source.object(),
            _ => None,
        }
    }

    /// The file that is at fault, if it is one.
    pub fn file(&self) -> Option<String> {
        match self {
            Self::Mesh(error) => Some(error.path().display().to_string()),
            Self::Input(InputError::Read { file, .. } | InputError::NoPaths { file })
            | Self::Check(CheckError::Differs { file, .. }) => Some(file.clone()),
            Self::Input(InputError::Project { file, .. }) => file.clone(),
            _ => None,
        }
    }

    /// Where in that file, layer or script it is, if that is known: `line 12`, `facet 3`, `layer 4`.
    pub fn place(&self) -> Option<String> {
        match self {
            Self::Mesh(error) => error.place(),
            Self::Settings(error) => error.problems.first().map(|problem| problem.origin.to_string()),
            Self::Check(CheckError::Fault { at, .. }) => Some(format!("line {}", at.line)),
            Self::Check(CheckError::InMidAir { layer, .. }) => Some(format!("layer {layer}")),
            _ => None,
        }
    }

    /// The key of the first setting that is at fault, if it is one.
    pub fn key(&self) -> Option<&str> {
        let Self::Settings(error) = self else { return None };
        error.problems.iter().find_map(|problem| Some(problem.setting.as_ref()?.0.as_str()))
    }
}

/// Why nothing can be made of what is given (exit code 3). `hints`: sizes of models that point to another unit.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)]
pub enum InputError {
    #[error("{file}: {source}")]
    Read { file: String, source: io::Error },
    #[error("the project{}: {problem}", file.as_ref().map_or(String::new(), |file| format!(", {file}")))]
    Project { file: Option<String>, problem: String },
    #[error("the G-code cannot be read: {source}")]
    Gcode { source: io::Error },
    #[error("there are no moves in it; is it G-code?")]
    NoMoves,
    #[error("{file}: nothing is printed in it")]
    NoPaths { file: String },
    #[error("there is nothing to print: no layer's middle lies inside the model; {}", mend(hints))]
    NoLayers { hints: Vec<String> },
    #[error(
        "{object}: it is too thin to be printed anywhere; scale it, or use a finer nozzle{}",
        after(hints)
    )]
    TooThin { object: String, hints: Vec<String> },
    #[error(
        "{layers} layers; at most {most} are made: choose a larger layer.height, or check the model's unit"
    )]
    TooManyLayers { layers: u64, most: usize },
    #[error("the print is too large: {problem}; choose a larger layer.height or reduce the number of facets")]
    TooLarge { problem: String },
    #[error(
        "one line without a stop prints one object; slice several with --each, or without spiral.enabled"
    )]
    SpiralOfSeveral { objects: usize },
    #[error(
        "at {z_mm:.2} mm the model is thinner than the line, which cannot go on; slice it without spiral.enabled{}",
        after(hints)
    )]
    SpiralEnds { z_mm: f64, hints: Vec<String> },
}

/// Hints after a message.
fn after(hints: &[String]) -> String {
    hints.iter().map(|hint| format!("; {hint}")).collect()
}

fn mend(hints: &[String]) -> String {
    match hints {
        [] => "choose a smaller layer.height".to_owned(),
        hints => hints.join("; "),
    }
}

/// Why models do not fit the printer (exit code 5). `hints`: sizes of models that point to another unit.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)]
pub enum FitError {
    #[error("{source}{}", after(hints))]
    Placement { source: Box<PlacementError>, hints: Vec<String> },
    #[error(
        "on its raft the print is {top_mm:.2} mm high, the printer {bed_mm} mm; give a smaller raft.layers or --scale"
    )]
    Raft { top_mm: f64, bed_mm: f64 },
    #[error(
        "{object} is {height_mm:.2} mm high, and {next} is to be printed after it: the gantry, {limit_mm} mm above the \
         nozzle (print.clearance_height), would strike it; print them layer by layer (print.sequence), or on plates of \
         their own with --each"
    )]
    Gantry { object: String, height_mm: f64, next: String, limit_mm: f64 },
    #[error(
        "{object}: {area_mm2:.0} mm² of it, the lowest at Z {z_mm:.2}, would be printed where the printer prints nothing \
         (bed.excluded); move it, or let it be arranged"
    )]
    Excluded { object: String, area_mm2: f64, z_mm: f64 },
    #[error(
        "there is no room on the bed for the prime tower of {width_mm:.0} × {depth_mm:.0} mm (without its brim), or it would stand \
         in something; give another prime_tower.position or prime_tower.width, or less to flush \
         (tool_change.flush_volumes)"
    )]
    PrimeTower { width_mm: f64, depth_mm: f64 },
}

/// What is wrong with a result (exit code 7).
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)]
pub enum CheckError {
    /// An object begins at `z_mm`, or goes on after nothing of it was printed from `last_mm` on; `mend` says what helps.
    #[error(
        "{object}: the print {} in mid-air at Z {z_mm:.2}: {}; {mend}, or give --allow-floating{}",
        if last_mm.is_some() { "goes on" } else { "begins" },
        cause(*last_mm, *z_mm, *on_thin), after(hints)
    )]
    InMidAir {
        object: String,
        layer: usize,
        z_mm: f64,
        last_mm: Option<f64>,
        /// What it has beneath is too thin to be printed.
        on_thin: bool,
        mend: &'static str,
        /// Sizes of models that point to another unit.
        hints: Vec<String>,
    },
    /// A file in another order does not print the same.
    #[error("{file}: {difference}; nothing was written")]
    Differs { file: String, difference: String },
    /// The first fault of a path.
    #[error(
        "the result failed its check, which is a mistake of this program; nothing was written: line {}: {}: {}",
        at.line, kind.text(), at.detail
    )]
    Fault { kind: Kind, at: Location },
}

fn cause(last_mm: Option<f64>, z_mm: f64, on_thin: bool) -> String {
    match last_mm {
        Some(last_mm) => format!("nothing of it is printed between Z {last_mm:.2} and Z {z_mm:.2}"),
        None if on_thin => "what it has beneath is too thin to be printed".to_owned(),
        None => "nothing is beneath it".to_owned(),
    }
}
