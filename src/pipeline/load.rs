//! Files → meshes on a plate.

use std::path::Path;

use geometry::real;

use crate::job::{FitError, InputError, Job, JobError, JobModel};
use crate::limits;
use crate::mesh::{self, Effect, Mesh, MeshError, SavedSettings, Transform, TransformError, Wish};
use crate::observer::Observer;
use crate::plate::{self, Arrange, Layout, Model, Object, Placement, PlacementError, Plate, Sequence};
use crate::profile::Settings;
use crate::report::{ModelInfo, Repaired};
use crate::slice;
use crate::slice::LayerSettings;
use crate::units::Mm;

use super::room::{self, Arranged};
use crate::parallel::Workers;
use crate::plan::styles::Styles;
use crate::plan::supports::REACH_MM as SUPPORT_REACH_MM;

/// Header date where none is given: the same input gives the same bytes. 2026-01-01.
pub(super) const DATED: u64 = 1_767_225_600;

/// Models, placed.
pub(crate) struct Loaded<'a> {
    pub plate: Plate,
    /// What each object has of settings of its own.
    pub styles: Styles<'a>,
    /// Where support is enforced and where it is blocked: bodies on the same plate.
    pub modifiers: [Plate; 2],
    pub warnings: Vec<String>,
    pub repairs: Vec<Repaired>,
    /// Sizes that point to another unit.
    pub hints: Vec<String>,
    /// The middle of the room that is kept for the prime tower, and its size, millimetres.
    pub tower_room_mm: Option<[[f64; 2]; 2]>,
    /// Widths of what each tool prints beside the objects, on the first layer and on others, millimetres.
    pub widths_mm: [Vec<f64>; 2],
}

/// Reads and transforms the models of a job. A file that is named several times is read once.
pub(crate) fn read(job: &Job, settings: &Settings, workers: Workers<'_>) -> Result<Vec<Model>, JobError> {
    let models = &job.models;
    let first = |i: usize| models.iter().position(|other| other.source == models[i].source).unwrap_or(i);
    let first: Vec<usize> = (0..models.len()).map(first).collect();
    let is_shared = |i: usize| first.iter().filter(|other| **other == i).count() > 1;
    let read_shared = |i: usize| is_shared(i).then(|| models[i].source.objects(workers)).transpose();
    let shared: Vec<Option<Vec<mesh::Model>>> =
        workers.map(models.len(), read_shared).into_iter().collect::<Result<_, _>>()?;
    let read = |i: usize| {
        let objects = match &shared[first[i]] {
            Some(objects) => objects.clone(),
            None => models[i].source.objects(workers)?,
        };
        model(&models[i], objects, job.scale_to_fit, settings)
    };
    workers.map(models.len(), read).into_iter().collect()
}

/// Places models as a job wants it.
pub(crate) fn place<'a>(
    models: Vec<Model>,
    job: &'a Job,
    settings: &Settings,
) -> Result<Loaded<'a>, JobError> {
    let first_box = models.first().map(|model| model.first_box);
    let hints: Vec<String> = models.iter().filter_map(|model| model.hint.clone()).collect();
    let mut warnings = hints.clone();
    let mut repairs: Vec<Repaired> = Vec::new();
    let mut names: Vec<Vec<String>> = Vec::new();
    let mut own: Vec<Option<&Settings>> = Vec::new();
    let mut tools: Vec<Option<u32>> = Vec::new();
    let mut saved: Vec<SavedSettings> = Vec::new();
    for (number, model) in models.iter().enumerate() {
        for (item, report) in model.layout.items().iter().zip(&model.reports) {
            warnings.extend(report.warnings.iter().map(|warning| format!("{}: {warning}", item.name)));
            repairs.extend(Repaired::of(&item.name, report));
            let copies = item.positions.len() * model.layout.copies();
            let known = [std::slice::from_ref(&item.name), &model.names].concat();
            names.extend(std::iter::repeat_n(known, copies));
            let settings = job.models.get(number).and_then(|model| model.settings.as_deref());
            own.extend(std::iter::repeat_n(settings, copies));
            tools.extend(std::iter::repeat_n(item.tool, copies));
            saved.extend(std::iter::repeat_n(item.saved.clone(), copies));
        }
    }
    let placement = placement(job, settings);
    let Arranged { plate, tower_room_mm } = room::place(models, job, &placement, settings)
        .map_err(|source| FitError::Placement { source: source.into(), hints: hints.clone() })?;
    check_size(&plate, &settings.layer)?;
    for (names, object) in names.iter_mut().zip(&plate.objects) {
        names.insert(0, object.name.clone());
    }
    warnings.extend(plate.notes.iter().cloned());
    let mut styles = Styles::new(&job.objects, &own, &names)?;
    warnings.extend(styles.take_tools(&tools, settings));
    warnings.extend(styles.take_saved(&saved, &names, settings));
    warnings.extend(styles.take_modifiers(&plate, settings));
    styles.take_widths(settings);
    let load = |bodies: &[JobModel]| load_modifiers(bodies, first_box, &plate, settings);
    let mut modifiers = [load(&job.support_enforcers)?, load(&job.support_blockers)?];
    for (wish, modifiers) in [Wish::Enforced, Wish::Blocked].into_iter().zip(&mut modifiers) {
        add_wishes(wish, &plate, modifiers);
    }
    Ok(Loaded {
        plate,
        styles,
        modifiers,
        warnings,
        repairs,
        hints,
        tower_room_mm,
        widths_mm: settings.widths_beside_mm(),
    })
}

/// Where the models of a job stand, and which objects cannot be printed there.
pub(super) fn placed(
    job: &Job,
    settings: &Settings,
    workers: Workers<'_>,
) -> Result<(Plate, Vec<(usize, PlacementError)>), JobError> {
    let models = read(job, settings, workers)?;
    let is_standing = job.models.iter().any(|model| model.at_mm.is_some());
    let hints = models.iter().filter_map(|model| model.hint.clone()).collect();
    let placement = self::placement(job, settings);
    let placed = match is_standing {
        true => {
            let layouts = models.into_iter().map(|model| model.layout).collect();
            plate::stand(layouts, &settings.bed, &placement)
        }
        false => room::place(models, job, &placement, settings).map(|arranged| (arranged.plate, Vec::new())),
    };
    Ok(placed.map_err(|source| FitError::Placement { source: source.into(), hints })?)
}

/// The objects of a file, transformed. What is larger than the bed is shrunk if requested, all by one factor. What has a
/// position is not oriented: it stands as it is turned.
pub(crate) fn model(
    wanted: &JobModel,
    objects: Vec<mesh::Model>,
    scale_to_fit: bool,
    settings: &Settings,
) -> Result<Model, JobError> {
    let (path, copies) = (wanted.path(), wanted.copies as usize);
    let line = plate::Line::thinnest(settings);
    let (objects, wanted_object) = match settings.tools.len() {
        0 | 1 => (objects, wanted.object),
        _ => by_tool(objects, wanted.object),
    };
    let mut model = Model::new(path, objects, wanted_object, &wanted.transform, line, copies)?;
    if settings.plate.orient && wanted.at_mm.is_none() {
        model.layout = model.layout.oriented();
    }
    if scale_to_fit {
        let factor = model.layout.fit_factor(&settings.bed, margin_mm(settings));
        model.layout = model.layout.scaled(factor).map_err(|source| unusable(path, source))?;
    }
    if let Some(at_mm) = wanted.at_mm {
        model.layout = model.layout.standing_at(at_mm);
    }
    Ok(model)
}

/// The objects of a file, or the one that is wanted, in parts that different tools print.
fn by_tool(mut objects: Vec<mesh::Model>, wanted: Option<usize>) -> (Vec<mesh::Model>, Option<usize>) {
    if let Some(object) = objects.get_mut(wanted.unwrap_or(0)) {
        let names = (1..).zip(&object.materials.names).map(|(tool, name)| format!("tool {tool} is {name}"));
        let names: Vec<String> = names.collect();
        if !names.is_empty() {
            object.report.warnings.push(format!("printed as its materials are listed: {}", names.join(", ")));
        }
    }
    match wanted {
        Some(object) if object < objects.len() => {
            let parts = objects.into_iter().nth(object).map(mesh::Model::by_tool);
            (parts.unwrap_or_default(), None)
        }
        Some(_) => (objects, wanted),
        None => (objects.into_iter().flat_map(mesh::Model::by_tool).collect(), None),
    }
}

/// How models are placed.
fn placement(job: &Job, settings: &Settings) -> Placement {
    let mut modifiers = job.support_enforcers.iter().chain(&job.support_blockers);
    let is_followed = modifiers.any(|modifier| modifier.at_mm.is_none());
    let one_by_one = settings.print.sequence == Sequence::Object;
    let apart_mm = if one_by_one { settings.print.clearance_radius.0 } else { 0.0 };
    Placement {
        margin_mm: margin_mm(settings),
        spacing_mm: settings.plate.spacing.0.max(apart_mm),
        reach_mm: reach_mm(settings),
        convex: one_by_one,
        turn: settings.plate.turn && !is_followed,
        arrange: match (settings.plate.arrange, settings.plate.keep_layout) {
            (true, true) => Arrange::Layouts,
            (true, false) => Arrange::Bodies,
            (false, _) => Arrange::Off,
        },
        shift_mm: job.translate_mm,
    }
}

/// Bodies where support is enforced or blocked: where they stand, or taken along by the first model, which was in `first_box`
/// before it was fitted and placed.
fn load_modifiers(
    bodies: &[JobModel],
    first_box: Option<[[f64; 3]; 2]>,
    plate: &Plate,
    settings: &Settings,
) -> Result<Plate, JobError> {
    let mut modifiers = Plate::default();
    let (Some([was, was_to]), Some(first)) = (first_box, plate.meshes.first()) else { return Ok(modifiers) };
    let [is, is_to] = first.bounds();
    let factor = (0..3).map(|i| (is_to[i] - is[i]) / (was_to[i] - was[i])).fold(0.0, f64::max);
    for body in bodies {
        if let Some(at_mm) = body.at_mm {
            stand_modifier(body, at_mm, settings, &mut modifiers)?;
            continue;
        }
        let mesh = single(body)?;
        let factor_only = Transform { scale: [factor; 3], ..Transform::default() };
        let mut mesh = transformed(body.path(), &factor_only, mesh)?;
        mesh.shift([0, 1, 2].map(|i| is[i] - factor * was[i]));
        let copies = plate.objects.iter().filter(|object| object.mesh == 0);
        modifiers
            .objects
            .extend(copies.map(|object| Object { mesh: modifiers.meshes.len(), ..object.clone() }));
        modifiers.meshes.push(mesh);
    }
    Ok(modifiers)
}

/// Adds the bodies that files have for where support is wanted, or not.
fn add_wishes(wish: Wish, plate: &Plate, to: &mut Plate) {
    for object in &plate.objects {
        let bodies = plate.meshes[object.mesh].modifiers().iter();
        for body in bodies.filter(|body| body.effect == Effect::Support(wish)) {
            to.objects.push(Object { mesh: to.meshes.len(), ..object.clone() });
            to.meshes.push(body.mesh.clone());
        }
    }
}

/// Puts a body where its position says, on the bed or not.
fn stand_modifier(
    body: &JobModel,
    at_mm: [f64; 3],
    settings: &Settings,
    modifiers: &mut Plate,
) -> Result<(), JobError> {
    let mesh = single(body)?;
    let layout = Layout::single(plate::name_of(body.path()), mesh, 1).standing_at(at_mm);
    let options = Placement { arrange: Arrange::Off, ..Placement::default() };
    let (standing, _) = plate::stand(vec![layout], &settings.bed, &options)
        .map_err(|source| FitError::Placement { source: source.into(), hints: Vec::new() })?;
    let first = modifiers.meshes.len();
    modifiers.meshes.extend(standing.meshes);
    let moved = standing.objects.into_iter().map(|object| Object { mesh: first + object.mesh, ..object });
    modifiers.objects.extend(moved);
    Ok(())
}

/// What is in the first model of a job, and whether it fits.
pub(super) fn info(job: &Job, settings: &Settings) -> Result<ModelInfo, JobError> {
    let Some(wanted) = job.models.first() else { return Err(nothing_to_print(&[])) };
    let observer = Observer::none();
    let objects = wanted.source.objects(Workers { observer: &observer })?;
    let Model { layout, mut reports, hint, .. } = model(wanted, objects, job.scale_to_fit, settings)?;
    let (mesh, mut report) = match (layout.items(), reports.len()) {
        ([only], 1) => (only.mesh.clone(), reports.remove(0)),
        _ => {
            let (mesh, report) = wanted.source.whole()?;
            (transformed(wanted.path(), &wanted.transform, mesh)?, report)
        }
    };
    // Scaling and turning leave the share as it is.
    let (sum_mm3, _) = mesh.volume_and_area();
    if sum_mm3 > 0.0 {
        report.volume_mm3 *= slice::volume_mm3(&mesh) / sum_mm3;
    }
    report.warnings.extend(hint);
    let mut text = report.to_string();
    let (objects, bodies) = (layout.object_count(), layout.body_count());
    if objects > 1 {
        text.push_str(&format!(
            "layout      {objects} objects in {bodies} {}\n",
            match bodies {
                1 => "body: they interlock, and are moved together",
                _ => "bodies",
            }
        ));
        for item in layout.items() {
            text.push_str(&format!("object      {} × {}\n", item.positions.len(), item.name));
        }
    }
    let placed = plate::place(vec![layout], &settings.bed, &placement(job, settings));
    let advice = match &placed {
        Ok(plate) => {
            plate.notes.iter().for_each(|note| text.push_str(&format!("warning     {note}\n")));
            None
        }
        Err(error) => Some(error.to_string()),
    };
    Ok(ModelInfo {
        file: wanted.path().display().to_string(),
        mesh: serde_json::to_value(&report).unwrap_or_default(),
        text,
        objects,
        bodies,
        fits: advice.is_none(),
        advice,
    })
}

/// A file, or one object of it, as one mesh, transformed.
fn single(body: &JobModel) -> Result<Mesh, JobError> {
    let mesh = match body.object {
        None => body.source.whole()?.0,
        Some(index) => {
            let objects = body.source.objects(Workers { observer: &Observer::none() })?;
            let count = objects.len();
            let missing =
                || MeshError::NoObject { path: body.path().to_path_buf(), object: index, objects: count };
            objects.into_iter().nth(index).ok_or_else(missing)?.mesh
        }
    };
    transformed(body.path(), &body.transform, mesh)
}

fn transformed(path: &Path, transform: &Transform, mesh: Mesh) -> Result<Mesh, JobError> {
    transform.apply(mesh).map_err(|source| unusable(path, source).into())
}

fn unusable(path: &Path, source: TransformError) -> MeshError {
    MeshError::Transform { path: path.to_path_buf(), source }
}

/// Room that support, raft, brim and skirt take around the models.
fn margin_mm(settings: &Settings) -> f64 {
    let width_mm = settings.walls.width.0.max(settings.first_layer.width.0);
    let skirt_mm = if settings.skirt.loops > 0 {
        settings.skirt.distance.0 + f64::from(settings.skirt.loops) * width_mm
    } else {
        0.0
    };
    let shield_mm = match settings.tool_change.ooze_shield && settings.tools.len() > 1 {
        true => settings.tool_change.ooze_shield_distance.0 + 2.0 * width_mm,
        false => 0.0,
    };
    reach_mm(settings) + skirt_mm.max(shield_mm)
}

/// Room that support, raft and brim take around each model.
fn reach_mm(settings: &Settings) -> f64 {
    let support_mm = if settings.support.enabled { SUPPORT_REACH_MM } else { 0.0 };
    let raft_mm = if settings.raft.layers > 0 { settings.raft.margin.0 } else { 0.0 };
    let brim_mm = if settings.brim.width.0 > 0.0 { settings.brim.width.0 + settings.brim.gap.0 } else { 0.0 };
    brim_mm.max(support_mm + raft_mm)
}

/// The layers that the part is cut into: on a raft it has no elephant's foot.
pub(super) fn layers(settings: &Settings) -> LayerSettings {
    let foot = if settings.raft.layers > 0 { Mm(0.0) } else { settings.layer.elephant_foot };
    LayerSettings { elephant_foot: foot, ..settings.layer.clone() }
}

/// Whether a print on a raft is still as low as the printer asks.
pub(super) fn check_height(top_mm: f64, settings: &Settings) -> Result<(), JobError> {
    let (top_mm, bed_mm) = (top_mm - settings.layer.z_offset.0, settings.bed.height.0);
    if settings.raft.layers == 0 || top_mm <= bed_mm + settings.layer.height.0 / 2.0 {
        return Ok(());
    }
    Err(FitError::Raft { top_mm, bed_mm }.into())
}

/// Whether the plate can be cut into this many layers.
pub(super) fn check_size(plate: &Plate, settings: &LayerSettings) -> Result<(), JobError> {
    let (first_mm, height_mm) = (settings.first_height.0, settings.height.0);
    let top_mm = plate.meshes.iter().map(|mesh| mesh.bounds()[1][2]).fold(0.0, f64::max);
    let layers = (top_mm - first_mm).max(0.0) / height_mm + 1.0;
    if layers > limits::LAYERS as f64 {
        let layers = layers.round_ties_even() as u64;
        return Err(InputError::TooManyLayers { layers, most: limits::LAYERS }.into());
    }
    let crossed = |mesh: &Mesh, triangle: &[u32; 3]| {
        let z = triangle.map(|v| mesh.vertices()[v as usize][2]);
        let high = real::greater(real::greater(z[0], z[1]), z[2]);
        let low = real::lesser(real::lesser(z[0], z[1]), z[2]);
        ((high - low) / height_mm).ceil() as u64
    };
    let crossings: u64 =
        plate.meshes.iter().flat_map(|mesh| mesh.triangles().iter().map(|t| crossed(mesh, t))).sum();
    let too_large = |problem| InputError::TooLarge { problem };
    if crossings > limits::CROSSINGS {
        let millions = |count: u64| count / 1_000_000;
        let (crossings, most) = (millions(crossings), millions(limits::CROSSINGS));
        return Err(too_large(format!(
            "layers cross {crossings} million facets; at most {most} are allowed"
        ))
        .into());
    }
    Ok(limits::check_memory(crossings * limits::BYTES_PER_CROSSING).map_err(too_large)?)
}

/// No layer has a section. `hints`: sizes that point to another unit.
pub(super) fn nothing_to_print(hints: &[String]) -> JobError {
    InputError::NoLayers { hints: hints.to_vec() }.into()
}
