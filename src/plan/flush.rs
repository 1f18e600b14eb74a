//! What tools are flushed into beside the prime tower: infill, support, and objects whose color does not matter.

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

/// Lets tools be flushed into the infill or support that they print right after they are taken, where that is wanted, and what
/// that does not take into the objects that `takes` names, whose paths the first tool of each layer has so far.
pub(crate) fn into(layers: &mut [LayerPaths], takes: impl Fn(u32) -> bool, settings: &Settings) {
    let change = &settings.tool_change;
    let roles =
        [(Role::InternalInfill, change.flush_into_infill), (Role::Support, change.flush_into_support)];
    let is_taken = |role: Role| roles.contains(&(role, true));
    let mut current = layers.iter().find_map(|layer| layer.tools.first().copied());
    for layer in layers {
        let kept = layer.tools.first().copied().filter(|first| Some(*first) == current);
        for path in layer.paths.iter_mut().filter(|path| is_taken(path.role) && path.tool != kept) {
            path.phase = Phase::Tower(SPARSE);
        }
        into_objects(layer, current, &takes, settings);
        current = layer.tools.last().copied().or(current);
    }
}

/// Gives each tool that a layer changes to as much of the objects as it has to be flushed, as far as there is.
fn into_objects(
    layer: &mut LayerPaths,
    before: Option<ToolId>,
    takes: impl Fn(u32) -> bool,
    settings: &Settings,
) {
    let LayerPaths { paths, islands, .. } = &*layer;
    let is_free = |path: &Path| {
        let takes = path.island.is_some_and(|island| takes(islands[island.index()].object));
        takes && !matches!(path.phase, Phase::Tower(_))
    };
    let mut free = (0..paths.len()).filter(|&path| is_free(&paths[path])).collect::<Vec<_>>().into_iter();
    let mut current = before;
    for next in layer.tools.clone() {
        let Some(from) = current.replace(next).filter(|from| *from != next) else { continue };
        let mut left_mm3 = settings.flush_mm3(from.into(), next.into()) - flushed_into_mm3(layer, next);
        while left_mm3 > 0.0
            && let Some(path) = free.next()
        {
            let path = &mut layer.paths[path];
            left_mm3 -= volume_mm3(path);
            let rank = if let Phase::Wall(depth) = path.phase { WALLS + depth } else { REST };
            (path.tool, path.phase) = (Some(next), Phase::Tower(rank));
        }
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
