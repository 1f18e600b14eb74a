//! Finished layers, for callers that need more than the G-code.

use crate::estimate::{Machine, move_times_s};
use crate::motion::{LayerMoves, Move};
use crate::order::PathVisit;
use crate::toolpath::{LayerPaths, Path, Width};

/// A layer of a print, as it is printed.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct PrintLayer {
    /// Index from the bed, 0 the first layer.
    pub index: usize,
    /// Height of the nozzle, millimetres, Z offset included.
    pub z_mm: f64,
    /// Height of the layer, millimetres.
    pub height_mm: f64,
    /// The paths in their order, each from where it is begun; role and width are theirs.
    pub paths: Vec<Path>,
    /// Commands to the machine.
    pub moves: Vec<Move>,
    /// How long each move takes, seconds.
    pub move_times_s: Vec<f64>,
}

impl PrintLayer {
    pub(super) fn new(layer: &LayerPaths, order: &[PathVisit], moves: LayerMoves, machine: &Machine) -> Self {
        let path = |visit: &PathVisit| begun_at(&layer.paths[visit.path as usize], visit.entry);
        let move_times_s = move_times_s(&moves, machine);
        let LayerMoves { index, z_mm, height_mm, moves, .. } = moves;
        Self { index, z_mm, height_mm, paths: order.iter().map(path).collect(), moves, move_times_s }
    }
}

/// A path as a visit draws it: a loop from its vertex of entry, an open path forwards (0) or backwards.
fn begun_at(path: &Path, entry: u32) -> Path {
    let mut path = path.clone();
    match (path.closed, entry) {
        (true, entry) => {
            path.points.rotate_left(entry as usize);
            if let Width::PerVertex(widths) = &mut path.width {
                widths.rotate_left(entry as usize);
            }
        }
        (false, 0) => {}
        (false, _) => {
            path.points.reverse();
            if let Width::PerVertex(widths) = &mut path.width {
                widths.reverse();
            }
        }
    }
    path
}
