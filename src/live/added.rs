//! Model files that were added to a session.

use serde::Serialize;

use crate::job::{ModelFile, Project};
use crate::mesh::{self, UnitHint};

/// A file that was added.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Added {
    /// What the session calls it: its name, made unique.
    pub file: String,
    /// Its size.
    pub bytes: usize,
    /// What it holds.
    pub objects: Vec<AddedObject>,
}

/// A file that was added, be it a model or a project with its models.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AddedFile {
    /// The file; of a project, with the name of its first model and the objects of all.
    #[serde(flatten)]
    pub added: Added,
    /// The project, with the names that its models have here.
    pub project: Option<Project>,
    /// The models of a project.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub files: Option<Vec<Added>>,
}

/// An object of a file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AddedObject {
    /// As the file calls it.
    pub name: Option<String>,
    /// Extents of its box, millimetres.
    pub size_mm: [f64; 3],
    /// Triangles after repair.
    pub triangles: usize,
    /// Enclosed volume.
    pub volume_mm3: f64,
    /// The middle of its box, seen from above, and its lowest point, in the file's coordinates, millimetres.
    pub at_mm: [f64; 3],
    /// What was repaired, in words.
    pub repairs: Vec<String>,
    /// What is doubtful about it.
    pub warnings: Vec<String>,
    /// The unit that its size points to, if that is not millimetres.
    pub hint: Option<UnitHint>,
}

impl Added {
    pub(super) fn of(file: &ModelFile) -> Self {
        let objects = file.objects().iter().map(AddedObject::of).collect();
        Self { file: file.name().to_owned(), bytes: file.bytes().len(), objects }
    }
}

impl AddedObject {
    fn of(model: &mesh::Model) -> Self {
        let report = &model.report;
        let [low, high] = model.mesh.bounds();
        let place = model.positions.first().copied().unwrap_or_default();
        let size_mm = [0, 1, 2].map(|i| high[i] - low[i]);
        Self {
            name: model.name.clone(),
            size_mm,
            triangles: model.mesh.triangles().len(),
            volume_mm3: report.volume_mm3,
            at_mm: [
                (low[0] + high[0]) / 2.0 + place[0],
                (low[1] + high[1]) / 2.0 + place[1],
                low[2] + place[2],
            ],
            repairs: report.repairs().iter().map(ToString::to_string).collect(),
            warnings: report.warnings.clone(),
            hint: UnitHint::of(size_mm, report.volume_mm3),
        }
    }
}
