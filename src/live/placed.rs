//! Where everything stands.

use serde::Serialize;

use crate::pipeline;
use crate::plate::{PlacementError, Plate};
use crate::profile::Settings;

/// Where everything stands, and what does not fit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Placed {
    /// The revision.
    pub revision: u64,
    /// In the order of the models.
    pub objects: Vec<PlacedObject>,
    /// What was not placed as its file has it, and why not everything fits.
    pub notes: Vec<String>,
}

/// An object on the bed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlacedObject {
    /// Number of its model in the project.
    pub model: usize,
    /// Which copy of the model it is.
    pub copy: usize,
    /// Which object of the copy it is, counted from 0.
    pub object: usize,
    /// What G-code and messages call it.
    pub name: String,
    /// Where the middle of its box, seen from above, and its lowest point are, in the bed's coordinates, millimetres.
    pub at_mm: [f64; 3],
    /// Angle by which the arrangement turned it about Z, degrees.
    pub rotate_z_deg: u32,
    /// Extents of its box, millimetres.
    pub size_mm: [f64; 3],
    /// Where objects are printed one after the other: how many come before it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub before: Option<usize>,
    /// Whether it can be printed there.
    pub fits: bool,
    /// Why not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

impl Placed {
    /// Of objects that are on the plate; `faults` are those that cannot be printed there.
    /// `models`: which model of the project, and which copy of it, each layout of the plate is; those of a plate that has
    /// copies of its own count from there.
    pub(super) fn of(
        revision: u64,
        plate: &Plate,
        models: &[(usize, usize)],
        faults: &[(usize, PlacementError)],
        settings: &Settings,
    ) -> Self {
        let turns = pipeline::turns(plate, settings);
        let mut objects: Vec<PlacedObject> = Vec::with_capacity(plate.objects.len());
        for (index, object) in plate.objects.iter().enumerate() {
            let [low, high] = plate.meshes[object.mesh].bounds();
            let fault = faults.iter().find(|(number, _)| *number == index);
            let (model, copy) = models.get(object.model).copied().unwrap_or_default();
            let copy = copy + object.copy;
            let known = objects.iter().filter(|o| (o.model, o.copy) == (model, copy)).count();
            objects.push(PlacedObject {
                model,
                copy,
                object: known,
                name: object.name.clone(),
                at_mm: object.at_mm,
                rotate_z_deg: 90 * (object.quarters % 4),
                size_mm: [0, 1, 2].map(|i| high[i] - low[i]),
                before: turns.as_ref().map(|turns| turns[index]),
                fits: fault.is_none(),
                reason: fault.map(|(_, error)| error.to_string()),
            });
        }
        Self { revision, objects, notes: plate.notes.clone() }
    }
}
