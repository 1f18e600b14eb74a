//! A print beside its model: is everything there, is nothing else there, and does it rest on something?
//!
//! The file is read twice more: once to find where on the bed the model stands, once to compare. What must be there is
//! the part of the sections at the bottom and the top of a layer that both have; what may be there is all that either
//! has, and a little around it. So it does not matter where within a layer a slicer cuts.

mod air;
mod align;
mod compare;
mod sections;
mod survey;

use std::fmt;
use std::io::{self, Read};

use serde::Serialize;

pub use survey::Survey;

use super::fault::Kind;
use super::report::{CheckReport, Found};
use crate::mesh::Mesh;
use crate::profile::Settings;
use sections::Sections;

/// A print holds more material than its model, up to this factor, where thin parts are printed wider than they are.
const MOST_VOLUME: f64 = 1.3;

/// How a print compares to its model.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ModelReport {
    /// Volume that the model encloses.
    pub mesh_volume_mm3: f64,
    /// Volume of the beads that belong to the model, without skirt, brim and support where the file tells them apart.
    pub part_volume_mm3: f64,
    /// Where the model's own zero stands on the bed; nothing if the model was not found.
    pub placed_at_mm: Option<[f64; 3]>,
    /// Islands of the model's sections, of all layers.
    pub islands: usize,
    /// Of these, the ones that are not printed.
    pub missing_islands: usize,
    /// Length of beads outside of the model.
    pub extra_mm: f64,
    /// Length of beads that rest on nothing and are not held at both ends.
    pub over_air_mm: f64,
}

impl fmt::Display for ModelReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { mesh_volume_mm3, part_volume_mm3, islands, missing_islands, .. } = self;
        let share = 100.0 * part_volume_mm3 / mesh_volume_mm3.max(f64::MIN_POSITIVE);
        writeln!(
            f,
            "  volume   {part_volume_mm3:.1} mm³ laid, {share:.1} % of the model's {mesh_volume_mm3:.1} mm³"
        )?;
        if let Some([x, y, z]) = self.placed_at_mm {
            writeln!(
                f,
                "  model    at X{x:.2} Y{y:.2} Z{z:.2}; {missing_islands} of {islands} islands missing"
            )?;
            writeln!(f, "  beads    {:.1} mm outside, {:.1} mm over air", self.extra_mm, self.over_air_mm)?;
        }
        Ok(())
    }
}

/// Compares a file, of which a survey was made, with its model, and adds to the report what it finds. `open` opens the
/// file anew.
///
/// # Errors
/// Those of reading.
pub fn against<R: Read>(
    mesh: &Mesh,
    survey: &Survey,
    open: impl Fn() -> io::Result<R>,
    settings: &Settings,
    report: &mut CheckReport,
) -> io::Result<()> {
    let mut found = Found::default();
    let area_mm2 = settings.filament.area_mm2();
    let mut model = ModelReport {
        mesh_volume_mm3: mesh.volume_and_area().0,
        part_volume_mm3: survey.part_volume_mm3(area_mm2),
        ..ModelReport::default()
    };
    let sections = Sections::new(mesh, survey, settings);
    match align::find(mesh, survey, &sections, settings, &open)? {
        None => found.add(Kind::NotPlaced, 1, None, || {
            "neither in the middle of the bed, nor where the print is, nor at its own place".into()
        }),
        Some(at_mm) => {
            model.placed_at_mm = Some([at_mm[0], at_mm[1], sections.bottom_mm()]);
            compare::compare(&sections, survey, at_mm, area_mm2, open()?, &mut model, &mut found)?;
            if survey.tells_roles() && model.part_volume_mm3 > MOST_VOLUME * model.mesh_volume_mm3 {
                found.add(Kind::OverVolume, 1, None, || {
                    format!("{:.1} mm³ of {:.1} mm³", model.part_volume_mm3, model.mesh_volume_mm3)
                });
            }
        }
    }
    report.extend(found);
    report.model = Some(model);
    Ok(())
}
