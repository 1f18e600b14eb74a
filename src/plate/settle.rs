//! Groups at their positions become objects on the bed.

use std::collections::BTreeMap;

use super::area::{Area, TOLERANCE_MM};
use super::error::PlacementError;
use super::group::{Group, corners, footprint};
use super::layout::{Item, Layout};
use super::objects::{Object, Plate};
use super::options::BedSettings;
use super::placement::Placement;
use crate::mesh::{Mesh, quarter_turned};
use geometry::Point;

/// Groups at their positions.
pub(super) struct PlacedGroups {
    pub groups: Vec<Group>,
    pub placed: Vec<PlacedGroup>,
    pub notes: Vec<String>,
}

/// A copy of a group: its middle relative to the bed's, and its rotation in quarter turns.
pub(super) struct PlacedGroup {
    pub group: usize,
    pub copy: usize,
    pub quarters: u32,
    pub at: [f64; 2],
}

/// The plate in bed coordinates, shifted as asked, and which objects reach how far beyond the edge of the bed. Objects are in
/// the order of layouts, items, copies and places.
///
/// # Errors
/// A shift upwards.
pub(super) fn settle(
    mut layouts: Vec<Layout>,
    standing: PlacedGroups,
    bed: &BedSettings,
    area: &Area,
    options: &Placement,
) -> Result<(Plate, Vec<(usize, f64)>), PlacementError> {
    let (middle, [dx, dy, dz]) = (bed.middle_mm(), options.shift_mm);
    // Layout, item, copy and place, each with where it stands.
    let mut slots = BTreeMap::new();
    let mut bodies = BTreeMap::new();
    for PlacedGroup { group, copy, quarters, at } in &standing.placed {
        let group = &standing.groups[*group];
        for part in &group.parts {
            let from_middle = quarter_turned(part.at, *quarters);
            let position = [at[0] + from_middle[0] + dx, at[1] + from_middle[1] + dy];
            let count = bodies.len();
            let body = *bodies.entry((group.layout, *copy, part.body)).or_insert(count);
            slots.insert(
                (group.layout, part.member.item, *copy, part.member.position),
                (*quarters, part.lift_mm, position, body),
            );
        }
    }
    if dz > 0.0 {
        return Err(PlacementError::InTheAir(dz));
    }
    let mut plate = Plate { meshes: Vec::new(), objects: Vec::new(), notes: standing.notes };
    let mut outside = Vec::new();
    // Layout, item, quarter turns and height over the bed of each mesh.
    let mut kinds: Vec<(usize, usize, u32, f64)> = Vec::new();
    for ((layout, item, copy, instance), (quarters, lift_mm, position, body)) in slots {
        let source = &layouts[layout].items[item];
        let number = copy * source.positions.len() + instance;
        let name =
            if number == 0 { source.name.clone() } else { format!("{} ({})", source.name, number + 1) };
        let [x, y, _] = source.foot(instance);
        let of_item = || corners(source, instance, [x, y]);
        let rim = footprint(source.size(), area.shape, quarters, of_item).rim;
        let by_mm = area.excess_mm(rim.iter().map(|p| [p[0] + position[0], p[1] + position[1]]));
        if by_mm > TOLERANCE_MM {
            outside.push((plate.objects.len(), by_mm));
        }
        let kind = (layout, item, quarters, lift_mm);
        let mesh = kinds.iter().position(|other| *other == kind).unwrap_or_else(|| {
            kinds.push(kind);
            kinds.len() - 1
        });
        let offset = Point::from_mm(position[0] + middle[0], position[1] + middle[1]);
        let [x, y] = offset.mm();
        let [model, item] = source.origin;
        let at_mm = [x, y, lift_mm + dz];
        plate.objects.push(Object { name, mesh, offset, body, model, item, copy, quarters, at_mm });
    }
    for (i, &(layout, item, quarters, lift_mm)) in kinds.iter().enumerate() {
        let Item { mesh, bounds, .. } = &mut layouts[layout].items[item];
        // Most models have one position only: then there is no need for a copy.
        let again = kinds[i + 1..].iter().any(|kind| (kind.0, kind.1) == (layout, item));
        let mesh = match again {
            true => mesh.clone(),
            false => std::mem::replace(mesh, Mesh::new(Vec::new(), Vec::new())),
        };
        let mut mesh = mesh.standing(*bounds).quarter_turned(quarters);
        mesh.shift([0.0, 0.0, lift_mm + dz]);
        plate.meshes.push(mesh);
    }
    Ok((plate, outside))
}
