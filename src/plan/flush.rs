//! What tools are flushed into beside the prime tower: infill, support, and objects whose color does not matter.

use std::collections::BTreeSet;

use crate::profile::Settings;
use crate::toolpath::{LayerPaths, Path, Phase, Role, ToolId, bead};

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

/// Lets tools be flushed into infill and support, where that is wanted, and into whole objects, whose paths the first tool of each
/// layer has so far. What is flushed into is printed right after the change. `of_object` are the settings of an object.
pub(crate) fn into<'s>(
    layers: &mut [LayerPaths],
    of_object: impl Fn(u32) -> &'s Settings,
    settings: &'s Settings,
) {
    let nozzle_mm = |tool: usize| settings.of_tool(tool).printer.nozzle_diameter.0;
    let nozzles_mm: Vec<f64> = (0..settings.tools.len()).map(nozzle_mm).collect();
    let mut current = layers.iter().find_map(|layer| layer.tools.first().copied());
    for layer in layers {
        let giver = Giver::of(layer, &of_object, settings, &nozzles_mm);
        for next in layer.tools.clone() {
            let Some(from) = current.replace(next).filter(|from| *from != next) else { continue };
            let mut left_mm3 = settings.flush_mm3(from.into(), next.into());
            for (place, number) in giver.to(next, layer) {
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

/// Gives what may be flushed into.
struct Giver<'n> {
    /// Of each path whether it is infill or support that may be flushed into, or is of an object that may.
    paths: Vec<Option<Kind>>,
    /// Tools that print something else, too: one that is there for nothing else keeps what it prints.
    others: BTreeSet<Option<ToolId>>,
    /// So does one whose lines are of another width.
    nozzles_mm: &'n [f64],
    /// Whether support has a tool of its own.
    keeps_support: bool,
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Infill,
    Support,
    Object,
}

impl<'n> Giver<'n> {
    fn of<'s>(
        layer: &LayerPaths,
        of_object: impl Fn(u32) -> &'s Settings,
        settings: &'s Settings,
        nozzles_mm: &'n [f64],
    ) -> Self {
        let kind = |path: &Path| {
            let own = path.island.map(|island| of_object(layer.islands[island.index()].object));
            match path.role {
                Role::Support if settings.tool_change.flush_into_support => Some(Kind::Support),
                Role::InternalInfill if own.is_some_and(|own| own.tool_change.flush_into_infill) => {
                    Some(Kind::Infill)
                }
                _ => own.filter(|own| own.tool_of.flush).map(|_| Kind::Object),
            }
        };
        let paths: Vec<Option<Kind>> = layer.paths.iter().map(kind).collect();
        let is_other = |kind: &Option<Kind>| matches!(kind, None | Some(Kind::Object));
        let others = layer.paths.iter().zip(&paths).filter(|(_, kind)| is_other(kind));
        let others = others.map(|(path, _)| path.tool).collect();
        Self { paths, others, nozzles_mm, keeps_support: settings.tool_of.support > 0 }
    }

    /// What is left for a tool, by number, the best first.
    fn to(&self, next: ToolId, layer: &LayerPaths) -> Vec<(Place, usize)> {
        let all = self.paths.iter().zip(&layer.paths).enumerate();
        let mut places: Vec<(Place, usize)> = all
            .filter(|(_, (_, path))| !matches!(path.phase, Phase::Tower(_)))
            .filter_map(|(number, (kind, path))| Some((self.place((*kind)?, path, next, layer)?, number)))
            .collect();
        places.sort_unstable();
        places
    }

    fn place(&self, kind: Kind, path: &Path, next: ToolId, layer: &LayerPaths) -> Option<Place> {
        let own = path.tool?;
        match kind {
            Kind::Object => Some(Place::Object),
            _ if own == next => Some(Place::Own),
            Kind::Support if self.keeps_support => None,
            _ => {
                let nozzle_mm = |tool: ToolId| self.nozzles_mm.get(usize::from(tool));
                let is_given = self.others.contains(&path.tool) && nozzle_mm(own) == nozzle_mm(next);
                let turn = |tool| layer.tools.iter().position(|other| *other == tool);
                is_given.then(|| if turn(own) < turn(next) { Place::Walled } else { Place::Open })
            }
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
    length_mm * bead::area_mm2(path.width.mean_mm(), path.height_mm)
}
