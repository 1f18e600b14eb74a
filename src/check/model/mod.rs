//! Compares a print with its model: missing parts, material outside of it, and beads over air.
//!
//! The file is read twice more: once to find where on the bed the model stands, once to compare. What must be there is
//! the part of the sections at the bottom and the top of a layer that both have; what may be there is all that either,
//! or the one in the middle, has, and a little around it. So it does not matter where within a layer a slicer cuts.

mod air;
mod align;
mod compare;
mod evidence;
mod levels;
mod sections;
mod survey;

use std::io::{self, Read};

pub use survey::Survey;
pub(super) use survey::is_part;

use super::beside::{ModelReport, PlacedBody};
use super::fault::Kind;
use super::report::{CheckReport, Found};
use crate::mesh::Mesh;
use crate::profile::Settings;
use align::{Placed, Search};
use geometry::Point;
use levels::Levels;
use sections::Sections;

/// A print holds more material than its model, up to this factor, where thin parts are printed wider than they are.
const MOST_VOLUME: f64 = 1.3;

/// Compares a surveyed file with its model and adds the faults to the report. `open` opens the file again. `bodies`
/// stand on z = 0, each with its name.
///
/// # Errors
/// Those of reading.
pub fn against<R: Read>(
    bodies: &[(String, Mesh)],
    survey: &Survey,
    open: impl Fn() -> io::Result<R>,
    settings: &Settings,
    report: &mut CheckReport,
) -> io::Result<()> {
    let mut found = Found::default();
    let area_mm2 = settings.filament.area_mm2();
    let volume_mm3 = |body: usize| crate::slice::volume_mm3(&bodies[body].1);
    let mut model = ModelReport {
        mesh_volume_mm3: (0..bodies.len()).map(volume_mm3).sum(),
        part_volume_mm3: survey.part_volume_mm3(area_mm2),
        ..ModelReport::default()
    };
    let levels = Levels::new(survey, settings);
    let shown = evidence::read(&levels, survey, open()?)?;
    let search = Search { bodies, survey, levels: &levels, shown: &shown, settings };
    let result = search.run();
    let lost: Vec<usize> = result.as_ref().map_or((0..bodies.len()).collect(), |result| result.lost.clone());
    for body in lost {
        found.add(Kind::NotPlaced, 1, None, || {
            format!(
                "{}: its walls are nowhere in the print, turned by quarters or not; check --model, --scale and --rotate",
                bodies[body].0
            )
        });
    }
    if let Some(result) = result {
        let turned: Vec<Mesh> = result
            .placed
            .iter()
            .map(|placed| bodies[placed.body].1.clone().quarter_turned(placed.quarters))
            .collect();
        let position = |placed: &Placed| Point::from_mm(placed.at_mm[0], placed.at_mm[1]);
        let in_place = turned.iter().zip(&result.placed).map(|(mesh, placed)| (mesh, vec![position(placed)]));
        let sections = Sections::new(in_place, &levels, result.bottom_mm, settings);
        model.mesh_volume_mm3 = result.placed.iter().map(|placed| volume_mm3(placed.body)).sum();
        let at_mm = |placed: &Placed| [placed.at_mm[0], placed.at_mm[1], result.bottom_mm];
        model.placed_at_mm = result.placed.first().map(at_mm);
        let placed = result.placed.iter().map(|placed| PlacedBody {
            name: bodies[placed.body].0.clone(),
            at_mm: at_mm(placed),
            turned_deg: 90 * placed.quarters,
        });
        model.placed = placed.collect();
        compare::compare(&sections, &levels, survey, area_mm2, open()?, &mut model, &mut found)?;
        if survey.has_roles() && model.part_volume_mm3 > MOST_VOLUME * model.mesh_volume_mm3 {
            found.add(Kind::OverVolume, 1, None, || {
                format!("{:.1} mm³ of {:.1} mm³", model.part_volume_mm3, model.mesh_volume_mm3)
            });
        }
    }
    report.extend(found);
    report.model = Some(model);
    Ok(())
}
