//! Room for the prime tower where models are arranged: where none is left for it, it is arranged with them, as one more model.

use std::collections::BTreeSet;

use crate::job::Job;
use crate::mesh::Mesh;
use crate::plan::tower::Tower;
use crate::plate::{self, Arrange, Layout, Model, Placement, PlacementError, Plate, Sequence};
use crate::profile::Settings;
use crate::toolpath::tool_heights;
use geometry::{Point, Region, Ring};

/// Models on the bed.
pub(super) struct Arranged {
    pub plate: Plate,
    /// The middle of the room that is kept for the tower, where the models leave no other, and its size, millimetres.
    pub tower_room_mm: Option<[[f64; 2]; 2]>,
}

/// Places models, and where they are arranged so that the tower has room.
///
/// # Errors
/// Those of [`plate::place`]. That there is no room for the tower is none: it may become smaller than is known here.
pub(super) fn place(
    models: Vec<Model>,
    job: &Job,
    placement: &Placement,
    settings: &Settings,
) -> Result<Arranged, PlacementError> {
    let towers = towers(&models, job, placement, settings);
    let layouts: Vec<Layout> = models.into_iter().map(|model| model.layout).collect();
    let Some(largest) = towers.first() else {
        let plate = plate::place(layouts, &settings.bed, placement)?;
        return Ok(Arranged { plate, tower_room_mm: None });
    };
    let plate = plate::place(layouts.clone(), &settings.bed, placement)?;
    let printed = geometry::offset(&seen_from_above(&plate), placement.margin_mm);
    if largest.clone().place(&printed, &printed, None, settings) {
        return Ok(Arranged { plate, tower_room_mm: None });
    }
    let with_room = towers.iter().find_map(|tower| beside(layouts.clone(), tower, placement, settings));
    Ok(with_room.unwrap_or(Arranged { plate, tower_room_mm: None }))
}

/// The models arranged with a tower; `None`: there is no room for all.
fn beside(
    mut layouts: Vec<Layout>,
    tower: &Tower,
    placement: &Placement,
    settings: &Settings,
) -> Option<Arranged> {
    let size_mm = tower.outer_mm();
    let number = layouts.len();
    layouts.push(Layout::single("prime tower", slab(size_mm), 1));
    let mut plate = plate::place(layouts, &settings.bed, placement).ok()?;
    let place = plate.objects.iter().position(|object| object.model == number)?;
    let stand_in = plate.objects.remove(place);
    // It is as wide along X as the tower.
    if !stand_in.quarters.is_multiple_of(2) {
        return None;
    }
    plate.meshes.remove(stand_in.mesh);
    plate.objects.iter_mut().filter(|o| o.mesh > stand_in.mesh).for_each(|object| object.mesh -= 1);
    let [x, y, _] = stand_in.at_mm;
    Some(Arranged { plate, tower_room_mm: Some([[x, y], size_mm]) })
}

/// Towers that are as large as the one to come can be, the larger first; empty: there is none, or it has a place.
fn towers(models: &[Model], job: &Job, placement: &Placement, settings: &Settings) -> Vec<Tower> {
    let is_free = placement.arrange != Arrange::Off
        && job.models.iter().all(|model| model.at_mm.is_none())
        && settings.print.sequence == Sequence::Layer;
    let tower = &settings.prime_tower;
    if settings.tools.len() < 2 || !tower.enabled || !tower.position.is_empty() || !is_free {
        return Vec::new();
    }
    let used = used(models, job, settings);
    let tops = models.iter().flat_map(|model| model.layout.items()).map(|item| {
        let [min, max] = item.mesh.bounds();
        max[2] - min[2]
    });
    let height_mm = tops.fold(0.0, f64::max);
    // A layer needs a change to each of its tools at most, or to all but the one that it begins with.
    let changes = [used.len(), used.len().saturating_sub(1)];
    changes.into_iter().filter_map(|changes| Tower::largest(&used, changes, height_mm, settings)).collect()
}

/// The tools that may print something, counted from 0.
fn used(models: &[Model], job: &Job, settings: &Settings) -> Vec<usize> {
    let mut used: BTreeSet<u32> = BTreeSet::new();
    let own = job.models.iter().filter_map(|model| model.settings.as_deref());
    let all = std::iter::once(settings).chain(job.objects.iter().map(|own| &own.settings)).chain(own);
    for of in all.map(|settings| &settings.tool_of) {
        used.extend([of.object, of.walls, of.infill, of.solid_infill]);
        used.extend(tool_heights(&of.heights).unwrap_or_default().iter().map(|at| u32::from(at.tool) + 1));
    }
    if settings.support.enabled || settings.raft.layers > 0 {
        used.extend([settings.tool_of.support, settings.tool_of.support_interface]);
    }
    for item in models.iter().flat_map(|model| model.layout.items()) {
        used.extend(item.tool);
        used.extend(item.mesh.paint().tools.iter().map(|facet| u32::from(facet.paint)));
    }
    let count = settings.tools.len();
    used.into_iter().filter_map(|tool| (tool as usize).checked_sub(1)).filter(|tool| *tool < count).collect()
}

/// The convex hulls of all objects.
fn seen_from_above(plate: &Plate) -> Region {
    let hull = |object: &plate::Object| -> Ring {
        let [x, y] = object.offset.mm();
        let corners = plate.meshes[object.mesh].vertices().iter().map(|v| [v[0] + x, v[1] + y]);
        let hull = crate::plan::sections::hull_mm(corners, 0.0);
        hull.into_iter().map(|[x, y]| Point::from_mm(x, y)).collect()
    };
    let rings: Vec<Ring> = plate.objects.iter().map(hull).filter(|ring| ring.len() >= 3).collect();
    geometry::unite_rings(&rings)
}

/// A box of a millimetre's height.
fn slab([width, depth]: [f64; 2]) -> Mesh {
    let corner = |n: usize| [[0.0, width][n & 1], [0.0, depth][n >> 1 & 1], [0.0, 1.0][n >> 2]];
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = sides.iter().flat_map(|&[a, b, c, d]: &[u32; 4]| [[a, b, c], [a, c, d]]);
    Mesh::new((0..8).map(corner).collect(), triangles.collect())
}
