//! Where on the bed a model was printed.

use std::io::{self, Read};

use super::sections::Sections;
use super::survey::{Survey, is_part};
use crate::gcode::{Action, Reader, each_line};
use crate::geom::{EdgeGrid, Point};
use crate::mesh::Mesh;
use crate::profile::Settings;
use crate::toolpath::Role;

/// So many layers are looked at.
const LAYERS: usize = 12;
/// At a place at least this share of the beads lies in the model's sections.
const FOUND: f64 = 0.6;

/// The shift in X and Y that takes the model to where it was printed; `None` if it is at none of the likely places: where
/// the print's outer walls are, where the print as a whole is, in the middle of the bed, where the model's own
/// coordinates say.
pub(super) fn find<R: Read>(
    mesh: &Mesh,
    survey: &Survey,
    sections: &Sections<'_>,
    settings: &Settings,
    open: impl Fn() -> io::Result<R>,
) -> io::Result<Option<[f64; 2]>> {
    let [low, high] = mesh.bounds();
    let middle = [0, 1].map(|i| (low[i] + high[i]) / 2.0);
    let to = |place: [f64; 2]| [place[0] - middle[0], place[1] - middle[1]];
    let extents = survey.extents().into_iter().flatten().map(|extent| to(extent.middle()));
    let candidates: Vec<[f64; 2]> = extents.chain([to(settings.bed.middle_mm()), [0.0; 2]]).collect();

    let count = sections.levels().len();
    let chosen: Vec<usize> = (0..LAYERS.min(count)).map(|i| i * count / LAYERS.min(count)).collect();
    let grids: Vec<EdgeGrid> = chosen.iter().map(|&i| EdgeGrid::new(&sections.layer(i).1)).collect();
    let mut hits = vec![0_usize; candidates.len()];
    let mut beads = 0;
    let mut reader = Reader::default();
    each_line(open()?, |line| {
        let read = reader.read(line);
        let Action::Stroke(bead) = read.action else { return };
        let role = read.context.role;
        let is_edge = if survey.has_edges() { Role::is_outer_wall } else { is_part };
        if !bead.extrudes() || survey.tells_roles() && !role.is_some_and(is_edge) {
            return;
        }
        let Some(at) = sections.find(bead.to[2]).and_then(|layer| chosen.iter().position(|&c| c == layer))
        else {
            return;
        };
        beads += 1;
        for (hits, shift) in hits.iter_mut().zip(&candidates) {
            let [x, y, _] = bead.at(0.5);
            *hits += usize::from(grids[at].contains(Point::from_mm(x - shift[0], y - shift[1])));
        }
    })?;
    let best = (0..candidates.len()).rev().max_by_key(|&i| hits[i]);
    Ok(best.filter(|&i| beads > 0 && hits[i] as f64 >= FOUND * beads as f64).map(|i| candidates[i]))
}
