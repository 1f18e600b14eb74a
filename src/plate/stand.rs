//! Models that stand where their positions say.

use std::collections::BTreeSet;

use super::area::{Area, TOLERANCE_MM};
use super::error::PlacementError;
use super::group::Group;
use super::layout::Layout;
use super::near::too_near;
use super::objects::Plate;
use super::options::BedSettings;
use super::placement::Placement;
use super::settle::{PlacedGroup, PlacedGroups, settle};

/// Places layouts where they say ([`Layout::standing_at`]), and finds which objects cannot be printed there, each by its number
/// on the plate: beyond the edge of the bed, too high, or with `convex` too near to another. That objects overlap is not
/// looked at.
///
/// # Errors
/// A layout without a position, or with copies; a shift upwards.
pub fn stand(
    mut layouts: Vec<Layout>,
    bed: &BedSettings,
    options: &Placement,
) -> Result<(Plate, Vec<(usize, PlacementError)>), PlacementError> {
    Layout::number(&mut layouts);
    let area = Area::new(bed, options.margin_mm);
    let [middle_x, middle_y] = bed.middle_mm();
    let (mut positioned, mut feet) = (Vec::with_capacity(layouts.len()), Vec::new());
    for (number, layout) in layouts.into_iter().enumerate() {
        let (layout, of_items) = positioned_layout(number, layout)?;
        positioned.push(layout);
        feet.extend(of_items);
    }
    let layout = Layout::joined(positioned);
    let mut group = Group::new(0, &layout, (0..layout.body_count()).collect());
    for part in &mut group.parts {
        let [x, y, z] = feet[part.member.item][part.member.position];
        part.at = [x - middle_x, y - middle_y];
        part.lift_mm = z;
    }
    let near = options.convex.then(|| too_near(&layout, &group.bodies, options.apart_mm())).flatten();
    let near = near.map(|pair| pair.map(|body| layout.bodies[body][0]));
    let placed = vec![PlacedGroup { group: 0, copy: 0, quarters: 0, at: [0.0; 2] }];
    let groups = PlacedGroups { groups: vec![group], placed, notes: Vec::new() };
    let counts: Vec<usize> = layout.items.iter().map(|item| item.positions.len()).collect();
    let (mut plate, outside) = settle(vec![layout], groups, bed, &area, options)?;
    number_names(&mut plate);
    share_meshes(&mut plate);

    let name = |object: usize| plate.objects[object].name.clone();
    let mut faults: Vec<(usize, PlacementError)> = Vec::new();
    for (object, by_mm) in outside {
        faults.push((object, PlacementError::OffBed { name: name(object), by_mm, bed: area.to_string() }));
    }
    for (index, object) in plate.objects.iter().enumerate() {
        let by_mm = plate.meshes[object.mesh].bounds()[1][2] - bed.height.0;
        if by_mm > TOLERANCE_MM {
            faults.push((index, PlacementError::TooHigh { name: name(index), by_mm }));
        }
    }
    if let Some(pair) = near {
        let [a, b] = pair.map(|m| counts[..m.item].iter().sum::<usize>() + m.position);
        let (name_a, name_b) = (name(a), name(b));
        let fault = PlacementError::TooNear { a: name_a, b: name_b, apart_mm: options.spacing_mm };
        faults.push((b, fault));
    }
    faults.sort_by_key(|(object, _)| *object);
    Ok((plate, faults))
}

/// Where the members of an item stand, one after the other.
type Feet = Vec<[f64; 3]>;

/// A layout whose items are at their positions on the bed, and where each of them stands.
fn positioned_layout(number: usize, mut layout: Layout) -> Result<(Layout, Vec<Feet>), PlacementError> {
    let Some([x, y, z]) = layout.at_mm else {
        return Err(PlacementError::NoPosition { name: layout.name });
    };
    if layout.copies > 1 {
        return Err(PlacementError::CopiesAtPosition { name: layout.name });
    }
    let group = Group::new(number, &layout, (0..layout.body_count()).collect());
    let mut feet: Vec<Feet> = layout.items.iter().map(|item| vec![[0.0; 3]; item.positions.len()]).collect();
    for part in &group.parts {
        let wanted = [x + part.at[0], y + part.at[1], z + part.lift_mm];
        let item = &mut layout.items[part.member.item];
        let is = item.foot(part.member.position);
        let position = &mut item.positions[part.member.position];
        *position = [0, 1, 2].map(|i| position[i] + (wanted[i] - is[i]));
        feet[part.member.item][part.member.position] = wanted;
    }
    Ok((layout, feet))
}

/// Numbers objects that are called alike, as copies are.
fn number_names(plate: &mut Plate) {
    let mut taken = BTreeSet::new();
    for object in &mut plate.objects {
        let own = object.name.clone();
        let mut number = 1;
        while !taken.insert(object.name.clone()) {
            number += 1;
            object.name = format!("{own} ({number})");
        }
    }
}

/// Makes objects share meshes that are equal, so that they are cut once.
fn share_meshes(plate: &mut Plate) {
    let mut first: Vec<usize> = Vec::with_capacity(plate.meshes.len());
    let mut kept: Vec<usize> = Vec::new();
    for (index, mesh) in plate.meshes.iter().enumerate() {
        let same = kept.iter().position(|&other| plate.meshes[other].is_same(mesh));
        first.push(same.unwrap_or(kept.len()));
        if same.is_none() {
            kept.push(index);
        }
    }
    let mut index = 0;
    plate.meshes.retain(|_| {
        index += 1;
        kept.contains(&(index - 1))
    });
    for object in &mut plate.objects {
        object.mesh = first[object.mesh];
    }
}
