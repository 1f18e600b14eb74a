//! Where models stand on the bed.

use super::area::{Area, TOLERANCE_MM, fitting_factor};
use super::arrange::{SearchOrder, Shape, arrange};
use super::error::{PlacementError, listed};
use super::group::Group;
use super::layout::Layout;
use super::near::too_near;
use super::objects::Plate;
use super::options::BedSettings;
use super::pack::pack;
use super::placement::{Arrange, Placement};
use super::settle::{PlacedGroup, PlacedGroups, settle};
use super::stand::stand;

/// Places models side by side, the whole group in the middle of the bed, or where their files put them.
///
/// Layouts (or bodies, see [`Arrange`]) are packed by their outlines, on cells of about a millimetre: around the middle of
/// the bed, or if that does not hold all of them, from a corner. Where neither does, boxes are packed to the micrometre.
/// Outlines never come closer than the spacing. Of a layout that does not fit, the bodies that do keep their places.
///
/// Layouts that have positions ([`Layout::standing_at`]) stand there; see [`stand`].
///
/// # Errors
/// A body larger than the bed, models larger than the bed together, a shift off the bed; what [`stand`] finds.
pub fn place(
    mut layouts: Vec<Layout>,
    bed: &BedSettings,
    options: &Placement,
) -> Result<Plate, PlacementError> {
    if layouts.iter().any(|layout| layout.at_mm.is_some()) {
        let (plate, faults) = stand(layouts, bed, options)?;
        return faults.into_iter().next().map_or(Ok(plate), |(_, fault)| Err(fault));
    }
    Layout::number(&mut layouts);
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
    let (plate, faults) = settle(layouts, standing, bed, &area, options)?;
    match faults.into_iter().next() {
        None => Ok(plate),
        Some((name, by_mm)) => {
            let name = plate.objects[name].name.clone();
            Err(PlacementError::Outside { name, by_mm, bed: area.to_string() })
        }
    }
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
        && let Some([a, b]) = too_near(layout, &group.bodies, options.apart_mm())
    {
        let [a, b] = [a, b].map(|body| Group::new(0, layout, vec![body]).name(layout, 0));
        return Err(PlacementError::TooNear { a, b, apart_mm: options.spacing_mm });
    }
    let middle = bed.middle_mm();
    let at = [0, 1].map(|i| group.middle[i] - middle[i]);
    let placed = vec![PlacedGroup { group: 0, copy: 0, quarters: 0, at }];
    Ok(PlacedGroups { groups: vec![group], placed, notes: Vec::new() })
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
        let apart_mm = options.apart_mm();
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
            options.apart_mm()
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
    let in_the_middle = |&(group, _): &(usize, usize)| {
        let group: &Group = &groups[group];
        let rim = group.footprint(&layouts[group.layout], area.shape, 0).rim;
        area.holds(rim.iter().copied())
    };
    if models.len() < 2 && models.iter().all(in_the_middle) {
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
        area.holds(rim.iter().map(|p| [p[0] + x, p[1] + y]))
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

impl Layout {
    /// The largest factor, at most 1, that makes each of its bodies fit the bed.
    pub fn fit_factor(&self, bed: &BedSettings, margin_mm: f64) -> f64 {
        let area = Area::new(bed, margin_mm);
        let share = |body| area.share(&Group::new(0, self, vec![body]).footprint(self, area.shape, 0));
        (0..self.body_count()).map(|body| fitting_factor(share(body))).fold(1.0, f64::min)
    }
}
