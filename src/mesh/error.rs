//! What can be wrong with an input file.

use std::fmt;
use std::path::{Path, PathBuf};

use super::transform::TransformError;

/// Where in a file something was found; both count from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Location {
    /// The n-th facet of a file that is no text.
    Facet(usize),
    /// The n-th line of a text file.
    Line(usize),
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Location::Facet(n) => write!(f, "facet {n}"),
            Location::Line(n) => write!(f, "line {n}"),
        }
    }
}

/// A file that cannot be made into a mesh (exit code 3). Each message names the file, the location and the remedy.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)]
pub enum MeshError {
    #[error("{}: cannot be read: {source}", path.display())]
    Read { path: PathBuf, source: std::io::Error },
    #[error("{}: the model is too large: {problem}; reduce its number of facets", path.display())]
    TooLarge { path: PathBuf, problem: String },
    #[error("{}: the file is empty; export the model again", path.display())]
    EmptyFile { path: PathBuf },
    #[error("{}: not an STL file, nor 3MF or OBJ ({found}); export the model as binary STL", path.display())]
    NotStl { path: PathBuf, found: &'static str },
    #[error(
        "{}: the file ends early: {promised} facets need {needed} bytes, {got} found ({whole} whole facets); \
         copy or export it again", path.display()
    )]
    Truncated { path: PathBuf, promised: usize, needed: u64, got: u64, whole: usize },
    #[error("{}: {location}: the file ends inside a facet; copy or export it again", path.display())]
    EndsInFacet { path: PathBuf, location: Location },
    #[error("{}: {location}: {problem}; export the model again, best as binary STL", path.display())]
    Syntax { path: PathBuf, location: Location, problem: String },
    #[error("{}: {part}: {problem}; {mend}", path.display())]
    Package { path: PathBuf, part: String, problem: String, mend: &'static str },
    #[error(
        "{}: {location}: coordinate {} is damaged{}; repair the model where it was made and export it again",
        path.display(), shown(*value), rest.as_ref().map_or(String::new(), |rest| format!(": the rest of the model is {rest}"))
    )]
    Damaged { path: PathBuf, location: Location, value: f32, rest: Option<String> },
    #[error(
        "{}: {count} of its corners lie far from the rest of the model, which is {rest}; repair it where it was made and \
         export it again", path.display()
    )]
    Stray { path: PathBuf, count: usize, rest: String },
    #[error("{}: {source}", path.display())]
    Transform { path: PathBuf, source: TransformError },
    #[error("{}: the model is longer than 10 m: {hint}", path.display())]
    TooLong { path: PathBuf, hint: String },
    #[error(
        "{}: its header promises {promised} facets, which take {needed} bytes, but it has {got}, and {location} is none; copy \
         or export it again", path.display()
    )]
    Count { path: PathBuf, promised: usize, needed: u64, got: u64, location: Location },
    #[error("{}: there is no object {object} in the file, which has {objects}; they count from 0", path.display())]
    NoObject { path: PathBuf, object: usize, objects: usize },
    #[error("{}: there is no facet in the file; export the model again", path.display())]
    NoFacets { path: PathBuf },
    #[error(
        "{}: the model has no volume ({:.3} × {:.3} × {:.3} mm, {}); a surface must be given a thickness \
         before it can be printed", path.display(), size[0], size[1], size[2], super::report::counted(*facets, "facet", "facets")
    )]
    NoVolume { path: PathBuf, size: [f64; 3], facets: usize },
}

impl MeshError {
    /// Where in the file, if that is known: `line 12`, `facet 3`, a part of a package.
    pub fn place(&self) -> Option<String> {
        match self {
            Self::EndsInFacet { location, .. }
            | Self::Syntax { location, .. }
            | Self::Damaged { location, .. }
            | Self::Count { location, .. } => Some(location.to_string()),
            Self::Package { part, .. } => Some(part.clone()),
            _ => None,
        }
    }

    /// The file.
    pub fn path(&self) -> &Path {
        match self {
            Self::Read { path, .. }
            | Self::TooLarge { path, .. }
            | Self::EmptyFile { path }
            | Self::NotStl { path, .. }
            | Self::Truncated { path, .. }
            | Self::EndsInFacet { path, .. }
            | Self::Syntax { path, .. }
            | Self::Package { path, .. }
            | Self::Damaged { path, .. }
            | Self::Stray { path, .. }
            | Self::Transform { path, .. }
            | Self::TooLong { path, .. }
            | Self::Count { path, .. }
            | Self::NoObject { path, .. }
            | Self::NoFacets { path }
            | Self::NoVolume { path, .. } => path,
        }
    }
}

/// A coordinate, without a row of zeros.
fn shown(value: f32) -> String {
    if value.is_finite() && value.abs() >= 1e9 { format!("{value:e}") } else { value.to_string() }
}
