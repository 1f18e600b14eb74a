//! What tools are flushed into beside the prime tower: infill, support, and objects whose color does not matter.

use std::collections::BTreeSet;

use crate::profile::Settings;
use crate::toolpath::{LayerPaths, Path, Phase, Role, ToolId, Width, bead};

/// The rank of infill and support that is flushed into.
const SPARSE: u32 = 3;
/// The ranks of what is flushed into of an object: its walls, by their depth, and all else.
const WALLS: u32 = 4;
const REST: u32 = 1000;

/// Frees the paths of objects that tools are flushed into: any tool may print them.
pub(crate) fn free(layer: &mut LayerPaths, takes: impl Fn(u32) -> bool) {
    let LayerPaths { paths, islands, .. } = layer;
    let is_free = |path: &Path| path.island.is_some_and(|island| takes(islands[island.index()].object));
    paths.iter_mut().filter(|path| is_free(path)).for_each(|path| path.tool = None);
}

/// Lets tools be flushed into infill and support, where that is wanted, and into the objects that `takes` names, whose paths the
/// first tool of each layer has so far. What is flushed into is printed right after the change.
pub(crate) fn into(layers: &mut [LayerPaths], takes: impl Fn(u32) -> bool, settings: &Settings) {
    let nozzle_mm = |tool: usize| settings.of_tool(tool).printer.nozzle_diameter.0;
    let nozzles_mm: Vec<f64> = (0..settings.tools.len()).map(nozzle_mm).collect();
    let mut current = layers.iter().find_map(|layer| layer.tools.first().copied());
    for layer in layers {
        // What is shared out is marked, so that none of it is given twice.
        let seen = Seen::of(layer, settings);
        for next in layer.tools.clone() {
            let Some(from) = current.replace(next).filter(|from| *from != next) else { continue };
            let mut left_mm3 = settings.flush_mm3(from.into(), next.into());
            let mut places: Vec<(Place, usize)> = (0..layer.paths.len())
                .filter_map(|number| {
                    Some((seen.place(&layer.paths[number], layer, next, &nozzles_mm, &takes)?, number))
                })
                .collect();
            places.sort_unstable();
            for (place, number) in places {
                if left_mm3 <= 0.0 {
                    break;
                }
                let path = &mut layer.paths[number];
                left_mm3 -= volume_mm3(path);
                let rank = match (place, path.phase) {
                    (Place::Object, Phase::Wall(depth)) => WALLS + depth,
                    (Place::Object, _) => REST,
                    _ => SPARSE,
                };
                (path.tool, path.phase) = (Some(next), Phase::Tower(rank));
            }
        }
    }
}

/// What a tool may be flushed into, the best first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Place {
    /// Infill and support that it prints anyway.
    Own,
    /// Those of a tool that has been there before: its walls are there already.
    Walled,
    /// Those of a tool that is still to come.
    Open,
    /// An object whose color does not matter.
    Object,
}

/// What of a layer is hidden, or not.
struct Seen {
    /// The roles of what is flushed into.
    hidden: Vec<Role>,
    /// Whether support has a tool of its own.
    keeps_support: bool,
    /// Tools that print something else, too.
    others: BTreeSet<Option<ToolId>>,
}

impl Seen {
    fn of(layer: &LayerPaths, settings: &Settings) -> Self {
        let change = &settings.tool_change;
        let roles =
            [(Role::InternalInfill, change.flush_into_infill), (Role::Support, change.flush_into_support)];
        let hidden: Vec<Role> =
            roles.into_iter().filter(|(_, is_taken)| *is_taken).map(|(role, _)| role).collect();
        let others =
            layer.paths.iter().filter(|path| !hidden.contains(&path.role)).map(|path| path.tool).collect();
        Self { hidden, keeps_support: settings.tool_of.support > 0, others }
    }

    /// What a path is to the tool that is taken; `None`: nothing to flush into.
    fn place(
        &self,
        path: &Path,
        layer: &LayerPaths,
        next: ToolId,
        nozzles_mm: &[f64],
        takes: impl Fn(u32) -> bool,
    ) -> Option<Place> {
        if matches!(path.phase, Phase::Tower(_)) {
            return None;
        }
        if !self.hidden.contains(&path.role) {
            return path
                .island
                .filter(|island| takes(layer.islands[island.index()].object))
                .map(|_| Place::Object);
        }
        let own = path.tool?;
        if own == next {
            return Some(Place::Own);
        }
        // A tool that is there for nothing else keeps what it prints, as does one whose lines are of another width.
        let is_given = self.others.contains(&path.tool)
            && nozzles_mm.get(usize::from(own)) == nozzles_mm.get(usize::from(next))
            && !(self.keeps_support && path.role == Role::Support);
        let turn = |tool| layer.tools.iter().position(|other| *other == tool);
        is_given.then(|| if turn(own) < turn(next) { Place::Walled } else { Place::Open })
    }
}

/// What a tool is flushed into beside the tower, mm³.
pub(super) fn flushed_into_mm3(layer: &LayerPaths, tool: ToolId) -> f64 {
    let of_tool = |path: &&Path| {
        let is_print = !matches!(path.role, Role::PrimeTower | Role::Skirt);
        path.tool == Some(tool) && is_print && matches!(path.phase, Phase::Tower(_))
    };
    layer.paths.iter().filter(of_tool).map(volume_mm3).sum()
}

fn volume_mm3(path: &Path) -> f64 {
    let length_mm = match path.closed {
        true => geometry::ring_length_mm(&path.points),
        false => geometry::polyline_length_mm(&path.points),
    };
    let width_mm = match &path.width {
        Width::Constant(width_mm) => *width_mm,
        Width::PerVertex(widths) => {
            widths.iter().map(|w| f64::from(*w)).sum::<f64>() / widths.len().max(1) as f64
        }
    };
    length_mm * bead::area_mm2(width_mm, path.height_mm)
}
