//! Where models stand on the bed.

use std::collections::BTreeMap;

use geo::{Distance, Euclidean};

use super::area::{Area, TOLERANCE_MM, fitting_factor};
use super::arrange::{SearchOrder, Shape, arrange};
use super::error::{PlacementError, listed};
use super::group::{Group, corners, footprint};
use super::layout::{Item, Layout, hull};
use super::objects::{Object, Plate};
use super::options::BedSettings;
use super::pack::pack;
use crate::mesh::{Mesh, quarter_turned};
use geometry::Point;

/// The method of arrangement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrange {
    /// Files, each with the layout that it has; where one does not fit, its bodies.
    Layouts,
    /// Bodies, each by itself.
    Bodies,
    /// The files' own coordinates, as those of the bed.
    Off,
}

/// How models are placed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Width to keep free along the bed's edge, for skirt and brim.
    pub margin_mm: f64,
    /// Least distance between models, and what is printed around them.
    pub spacing_mm: f64,
    /// How far brim, raft and supports reach around each model.
    pub reach_mm: f64,
    /// Whether models keep the distance from each other's convex hull, instead of only from the outline.
    pub convex: bool,
    /// Whether models may be turned by quarters about Z to fit.
    pub turn: bool,
    /// What is arranged.
    pub arrange: Arrange,
    /// Moves everything away from the middle of the bed; a negative Z sinks it, which cuts off the bottom.
    pub shift_mm: [f64; 3],
}

impl Default for Placement {
    fn default() -> Self {
        Self {
            margin_mm: 0.0,
            spacing_mm: 5.0,
            reach_mm: 0.0,
            convex: false,
            turn: false,
            arrange: Arrange::Layouts,
            shift_mm: [0.0; 3],
        }
    }
}

/// Places models side by side, the whole group in the middle of the bed, or where their files put them.
///
/// Layouts (or bodies, see [`Arrange`]) are packed by their outlines, on cells of about a millimetre: around the middle of
/// the bed, or if that does not hold all of them, from a corner. Where neither does, boxes are packed to the micrometre.
/// Outlines never come closer than the spacing. Of a layout that does not fit, the bodies that do keep their places.
///
/// # Errors
/// A body larger than the bed, models larger than the bed together, a shift off the bed.
pub fn place(layouts: Vec<Layout>, bed: &BedSettings, options: &Placement) -> Result<Plate, PlacementError> {
    let area = Area::new(bed, options.margin_mm);
    let (layouts, standing) = match options.arrange {
        Arrange::Off => {
            let layout = Layout::joined(layouts);
            let standing = as_they_are(&layout, bed, &area, options)?;
            (vec![layout], standing)
        }
        Arrange::Layouts | Arrange::Bodies => {
            let standing = arranged(&layouts, bed, &area, options)?;
            (layouts, standing)
        }
    };
    settle(layouts, standing, bed, &area, options)
}

/// Groups at their positions.
struct PlacedGroups {
    groups: Vec<Group>,
    placed: Vec<PlacedGroup>,
    notes: Vec<String>,
}

/// A copy of a group: its middle relative to the bed's, and its rotation in quarter turns.
struct PlacedGroup {
    group: usize,
    copy: usize,
    quarters: u32,
    at: [f64; 2],
}

/// Everything where the files have it.
fn as_they_are(
    layout: &Layout,
    bed: &BedSettings,
    area: &Area,
    options: &Placement,
) -> Result<PlacedGroups, PlacementError> {
    for body in 0..layout.body_count() {
        let group = Group::new(0, layout, vec![body]);
        area.check(&group.name(layout, 0), &group.footprint(layout, area.shape, 0))?;
    }
    let group = Group::new(0, layout, (0..layout.body_count()).collect());
    if options.convex
        && let Some([a, b]) = too_near(layout, &group.bodies, apart_mm(options))
    {
        let [a, b] = [a, b].map(|body| Group::new(0, layout, vec![body]).name(layout, 0));
        return Err(PlacementError::TooNear { a, b, apart_mm: options.spacing_mm });
    }
    let middle = bed.middle_mm();
    let at = [0, 1].map(|i| group.middle[i] - middle[i]);
    let placed = vec![PlacedGroup { group: 0, copy: 0, quarters: 0, at }];
    Ok(PlacedGroups { groups: vec![group], placed, notes: Vec::new() })
}

/// Least distance between bodies that are printed one after the other, with what is printed around them.
fn apart_mm(options: &Placement) -> f64 {
    options.spacing_mm + 2.0 * options.reach_mm
}

/// Two bodies of a layout that are nearer to each other than this.
fn too_near(layout: &Layout, bodies: &[usize], apart_mm: f64) -> Option<[usize; 2]> {
    let hulls: Vec<Vec<_>> = bodies
        .iter()
        .map(|&body| layout.bodies[body].iter().map(|m| hull(&layout.items[m.item], m.position)).collect())
        .collect();
    let near = |i: usize, j: usize| {
        hulls[i].iter().any(|a| hulls[j].iter().any(|b| Euclidean.distance(a, b) < apart_mm - TOLERANCE_MM))
    };
    let pairs = (0..bodies.len()).flat_map(|i| (0..i).map(move |j| [j, i]));
    pairs.into_iter().find(|&[j, i]| near(i, j)).map(|pair| pair.map(|i| bodies[i]))
}

/// How much of a layout is kept.
#[derive(Clone, Copy, PartialEq)]
enum Kept {
    All,
    /// What lies on the bed in the file's coordinates.
    OnBed,
    Nothing,
}

/// Why a layout is not kept.
#[derive(Clone, Copy)]
enum Reason {
    TooLarge,
    /// Bodies are too near to each other to be printed one after the other.
    TooNear,
    /// It would fit alone.
    NoRoom,
}

/// Groups packed on the bed: whole layouts, as far as they fit.
fn arranged(
    layouts: &[Layout],
    bed: &BedSettings,
    area: &Area,
    options: &Placement,
) -> Result<PlacedGroups, PlacementError> {
    let whole = |layout: &Layout| options.arrange == Arrange::Layouts && layout.kept;
    let mut kept: Vec<Kept> =
        layouts.iter().map(|layout| if whole(layout) { Kept::All } else { Kept::Nothing }).collect();
    let mut reasons = vec![Reason::NoRoom; layouts.len()];
    let several = layouts.iter().zip(kept.iter_mut().zip(&mut reasons));
    for (layout, (kept, reason)) in several.filter(|(layout, _)| layout.body_count() > 1) {
        let group = Group::new(0, layout, (0..layout.body_count()).collect());
        let fits = area.check("", &group.footprint(layout, area.shape, 0)).is_ok();
        let apart_mm = apart_mm(options);
        let apart = !options.convex || too_near(layout, &group.bodies, apart_mm).is_none();
        if *kept == Kept::All && !(fits && apart) {
            *kept = if apart { Kept::OnBed } else { Kept::Nothing };
            *reason = if fits { Reason::TooNear } else { Reason::TooLarge };
        }
    }
    loop {
        let groups: Vec<Group> = layouts
            .iter()
            .zip(&kept)
            .enumerate()
            .flat_map(|(number, (layout, kept))| groups(number, layout, *kept, bed, area))
            .collect();
        for group in &groups {
            let layout = &layouts[group.layout];
            area.check(&group.name(layout, 0), &group.footprint(layout, area.shape, 0))?;
        }
        let copies = |group: usize| (0..layouts[groups[group].layout].copies).map(move |copy| (group, copy));
        let models: Vec<(usize, usize)> = (0..groups.len()).flat_map(copies).collect();
        match packed(layouts, &groups, &models, area, options) {
            Ok(positions) => {
                let placed = models
                    .iter()
                    .zip(positions)
                    .map(|(&(group, copy), (quarters, at))| PlacedGroup { group, copy, quarters, at });
                let notes = layouts.iter().enumerate().filter(|(_, layout)| whole(layout));
                let notes = notes.filter_map(|(number, layout)| {
                    note(number, layout, reasons[number], &groups, area, options)
                });
                return Ok(PlacedGroups { placed: placed.collect(), notes: notes.collect(), groups });
            }
            Err(left) => {
                let divisible =
                    |(layout, kept): (&Layout, &Kept)| layout.body_count() > 1 && *kept != Kept::Nothing;
                if !layouts.iter().zip(&kept).any(divisible) {
                    return Err(too_many(layouts, &groups, &models, left, area, options));
                }
                kept.fill(Kept::Nothing);
            }
        }
    }
}

/// The groups of a layout of which so much is kept.
fn groups(number: usize, layout: &Layout, kept: Kept, bed: &BedSettings, area: &Area) -> Vec<Group> {
    let group = |bodies: Vec<usize>| Group::new(number, layout, bodies);
    let all = 0..layout.body_count();
    let middle = bed.middle_mm();
    let on_bed = |body: &usize| {
        let group = group(vec![*body]);
        let at = [0, 1].map(|i| group.middle[i] - middle[i]);
        let rim = group.footprint(layout, area.shape, 0).rim;
        area.excess_mm(rim.iter().map(|p| [p[0] + at[0], p[1] + at[1]])) <= TOLERANCE_MM
    };
    match kept {
        Kept::All => vec![group(all.collect())],
        Kept::Nothing => all.map(|body| group(vec![body])).collect(),
        Kept::OnBed => {
            let (stay, go): (Vec<usize>, Vec<usize>) = all.partition(on_bed);
            let stay = if stay.is_empty() { None } else { Some(group(stay)) };
            stay.into_iter().chain(go.into_iter().map(|body| group(vec![body]))).collect()
        }
    }
}

/// That a layout was not kept.
fn note(
    number: usize,
    layout: &Layout,
    reason: Reason,
    groups: &[Group],
    area: &Area,
    options: &Placement,
) -> Option<String> {
    let of_it: Vec<&Group> = groups.iter().filter(|group| group.layout == number).collect();
    if of_it.len() < 2 {
        return None;
    }
    let moved: Vec<String> =
        of_it.iter().filter(|group| group.bodies.len() == 1).map(|group| group.name(layout, 0)).collect();
    let all = Group::new(number, layout, (0..layout.body_count()).collect());
    let [w, d, _] = all.size;
    let reason = match reason {
        Reason::TooLarge => format!("its layout of {w:.1} × {d:.1} mm does not fit the printer's {area}"),
        Reason::TooNear => format!(
            "parts of its layout are nearer than {:.1} mm, too near to be printed one after the other",
            apart_mm(options)
        ),
        Reason::NoRoom => format!(
            "with its layout of {w:.1} × {d:.1} mm kept, not all models have room on the printer's {area}"
        ),
    };
    Some(format!("{}: {reason}; arranged anew: {}", layout.name, listed(&moved)))
}

fn too_many(
    layouts: &[Layout],
    groups: &[Group],
    models: &[(usize, usize)],
    left: Vec<usize>,
    area: &Area,
    options: &Placement,
) -> PlacementError {
    let name = |model: usize| {
        let (group, copy) = models[model];
        groups[group].name(&layouts[groups[group].layout], copy)
    };
    PlacementError::TooMany {
        total: models.len(),
        fitting: models.len() - left.len(),
        left: left.into_iter().map(name).collect(),
        spacing_mm: options.spacing_mm,
        bed: area.to_string(),
    }
}

/// The bed's longer side has this many cells when models are packed.
const CELLS: f64 = 256.0;

/// Quarter turn and place of the middle for each model, relative to that of the bed; or the models that do not fit.
fn packed(
    layouts: &[Layout],
    groups: &[Group],
    models: &[(usize, usize)],
    area: &Area,
    options: &Placement,
) -> Result<Vec<(u32, [f64; 2])>, Vec<usize>> {
    if models.len() < 2 {
        return Ok(vec![(0, [0.0; 2]); models.len()]);
    }
    let cell_mm = (2.0 * area.half[0].max(area.half[1]) / CELLS).max(0.1);
    let reach_mm = options.reach_mm + options.spacing_mm / 2.0;
    let shape = |group: &Group, quarters: u32| {
        let layout = &layouts[group.layout];
        Shape {
            covered: group.silhouette(layout, quarters, options.convex, reach_mm, cell_mm),
            rim: group.footprint(layout, area.shape, quarters).rim,
        }
    };
    let quarters = if options.turn { 4 } else { 1 };
    let shapes: Vec<Vec<Shape>> =
        groups.iter().map(|group| (0..quarters).map(|n| shape(group, n)).collect()).collect();
    let kinds: Vec<usize> = models.iter().map(|(group, _)| *group).collect();
    let half = area.half.map(|half| (half / cell_mm) as i64);
    let at_mm = |at: [i64; 2]| at.map(|n| n as f64 * cell_mm);
    let fits = |rim: &[[f64; 2]], at: [i64; 2]| {
        let [x, y] = at_mm(at);
        area.excess_mm(rim.iter().map(|p| [p[0] + x, p[1] + y])) <= TOLERANCE_MM
    };
    let mut left: Option<Vec<usize>> = None;
    for search_order in [SearchOrder::Middle, SearchOrder::Corner] {
        let positions = arrange(&shapes, &kinds, half, search_order, fits);
        let without: Vec<usize> = (0..models.len()).filter(|&model| positions[model].is_none()).collect();
        if without.is_empty() {
            let placed = positions
                .into_iter()
                .flatten()
                .map(|position| (position.turn as u32, at_mm(position.at)))
                .collect();
            return Ok(area.in_the_middle(placed, |model, turn| &shapes[kinds[model]][turn as usize].rim));
        }
        if left.as_ref().is_none_or(|left| without.len() < left.len()) {
            left = Some(without);
        }
    }
    let boxes: Vec<_> = kinds
        .iter()
        .map(|&group| groups[group].footprint(&layouts[groups[group].layout], area.shape, 0))
        .collect();
    let positions = pack(&boxes, 2.0 * reach_mm, |placed, positions| area.group_share(placed, positions));
    let unplaced = left.unwrap_or_default();
    match positions {
        Ok(positions) => Ok(positions.into_iter().map(|position| (0, position)).collect()),
        Err(boxes_left) if boxes_left.len() < unplaced.len() => Err(boxes_left),
        Err(_) => Err(unplaced),
    }
}

/// The plate in bed coordinates, shifted as asked. Objects are in the order of layouts, items, copies and places.
fn settle(
    mut layouts: Vec<Layout>,
    standing: PlacedGroups,
    bed: &BedSettings,
    area: &Area,
    options: &Placement,
) -> Result<Plate, PlacementError> {
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
            return Err(PlacementError::Outside { name, by_mm, bed: area.to_string() });
        }
        let kind = (layout, item, quarters, lift_mm);
        let mesh = kinds.iter().position(|other| *other == kind).unwrap_or_else(|| {
            kinds.push(kind);
            kinds.len() - 1
        });
        let offset = Point::from_mm(position[0] + middle[0], position[1] + middle[1]);
        plate.objects.push(Object { name, mesh, offset, body });
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
    Ok(plate)
}

impl Layout {
    /// The largest factor, at most 1, that makes each of its bodies fit the bed.
    pub fn fit_factor(&self, bed: &BedSettings, margin_mm: f64) -> f64 {
        let area = Area::new(bed, margin_mm);
        let share = |body| area.share(&Group::new(0, self, vec![body]).footprint(self, area.shape, 0));
        (0..self.body_count()).map(|body| fitting_factor(share(body))).fold(1.0, f64::min)
    }
}
