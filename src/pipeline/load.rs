//! Files → meshes on a plate.

use std::path::{Path, PathBuf};

use crate::job::{FitError, InputError, Job, JobError, TransformOptions};
use crate::limits;
use crate::mesh::{self, Mesh, MeshError, MeshReport, Transform, TransformError};
use crate::plate::{self, Arrange, Model, Object, Placement, Plate, Sequence};
use crate::profile::Settings;
use crate::report::{ModelInfo, Repaired};
use crate::slice;
use crate::slice::LayerSettings;
use crate::units::Mm;

use crate::parallel::Workers;
use crate::plan::styles::Styles;
use crate::plan::supports::REACH_MM as SUPPORT_REACH_MM;

/// Header date where none is given: the same input gives the same bytes. 2026-01-01.
pub(super) const DATED: u64 = 1_767_225_600;

/// Models, placed.
pub(super) struct Loaded<'a> {
    pub plate: Plate,
    /// What each object has of settings of its own.
    pub styles: Styles<'a>,
    /// Where support is enforced and where it is blocked: bodies on the same plate.
    pub modifiers: [Plate; 2],
    pub warnings: Vec<String>,
    pub repairs: Vec<Repaired>,
    /// Sizes that point to another unit.
    pub hints: Vec<String>,
}

/// Reads and transforms the models of a job.
pub(super) fn read(job: &Job, settings: &Settings, workers: Workers<'_>) -> Result<Vec<Model>, JobError> {
    let read = |i: usize| {
        let path = &job.models[i];
        let objects = mesh::load_watched(path, workers)?;
        model(path, objects, &job.transform, job.copies as usize, settings)
    };
    workers.map(job.models.len(), read).into_iter().collect()
}

/// Places models as a job wants it.
pub(super) fn place<'a>(
    models: Vec<Model>,
    job: &'a Job,
    settings: &Settings,
) -> Result<Loaded<'a>, JobError> {
    let first_box = models.first().map(|model| model.first_box);
    let hints: Vec<String> = models.iter().filter_map(|model| model.hint.clone()).collect();
    let mut warnings = hints.clone();
    let mut repairs: Vec<Repaired> = Vec::new();
    let mut names: Vec<Vec<String>> = Vec::new();
    for model in &models {
        for (item, report) in model.layout.items().iter().zip(&model.reports) {
            warnings.extend(report.warnings.iter().map(|warning| format!("{}: {warning}", item.name)));
            repairs.extend(Repaired::of(&item.name, report));
            let copies = item.positions.len() * model.layout.copies();
            let known = [std::slice::from_ref(&item.name), &model.names].concat();
            names.extend(std::iter::repeat_n(known, copies));
        }
    }
    let has_modifiers = !job.support_enforcers.is_empty() || !job.support_blockers.is_empty();
    let placement =
        Placement { turn: settings.plate.turn && !has_modifiers, ..placement(settings, &job.transform) };
    let layouts = models.into_iter().map(|model| model.layout).collect();
    let plate = plate::place(layouts, &settings.bed, &placement)
        .map_err(|source| FitError::Placement { source: source.into(), hints: hints.clone() })?;
    check_size(&plate, &settings.layer)?;
    for (names, object) in names.iter_mut().zip(&plate.objects) {
        names.insert(0, object.name.clone());
    }
    warnings.extend(plate.notes.iter().cloned());
    let styles = Styles::new(&job.objects, &names)?;
    let load = |files| load_modifiers(files, job, first_box, &plate);
    let modifiers = [load(&job.support_enforcers)?, load(&job.support_blockers)?];
    Ok(Loaded { plate, styles, modifiers, warnings, repairs, hints })
}

/// The objects of a file, transformed. What is larger than the bed is shrunk if requested, all by one factor.
pub(crate) fn model(
    path: &Path,
    objects: Vec<mesh::Model>,
    options: &TransformOptions,
    copies: usize,
    settings: &Settings,
) -> Result<Model, JobError> {
    let line = plate::Line::thinnest(settings);
    let mut model = Model::new(path, objects, &transform(options), line, copies)?;
    if settings.plate.orient {
        model.layout = model.layout.oriented();
    }
    if options.scale_to_fit {
        let factor = model.layout.fit_factor(&settings.bed, margin_mm(settings));
        model.layout = model.layout.scaled(factor).map_err(|source| unusable(path, source))?;
    }
    Ok(model)
}

/// How models are placed.
fn placement(settings: &Settings, options: &TransformOptions) -> Placement {
    let one_by_one = settings.print.sequence == Sequence::Object;
    let apart_mm = if one_by_one { settings.print.clearance_radius.0 } else { 0.0 };
    Placement {
        margin_mm: margin_mm(settings),
        spacing_mm: settings.plate.spacing.0.max(apart_mm),
        reach_mm: reach_mm(settings),
        convex: one_by_one,
        turn: settings.plate.turn,
        arrange: match (settings.plate.arrange, settings.plate.keep_layout) {
            (true, true) => Arrange::Layouts,
            (true, false) => Arrange::Bodies,
            (false, _) => Arrange::Off,
        },
        shift_mm: options.translate_mm,
    }
}

/// Bodies taken along by the first model, which was in `first_box` before it was fitted and placed.
fn load_modifiers(
    files: &[PathBuf],
    job: &Job,
    first_box: Option<[[f64; 3]; 2]>,
    plate: &Plate,
) -> Result<Plate, JobError> {
    let mut modifiers = Plate::default();
    let (Some([was, was_to]), Some(first)) = (first_box, plate.meshes.first()) else { return Ok(modifiers) };
    let [is, is_to] = first.bounds();
    let factor = (0..3).map(|i| (is_to[i] - is[i]) / (was_to[i] - was[i])).fold(0.0, f64::max);
    for file in files {
        let (mesh, _) = single(file, &job.transform)?;
        let factor_only = Transform { scale: [factor; 3], ..Transform::default() };
        let mut mesh = transformed(file, &factor_only, mesh)?;
        mesh.shift([0, 1, 2].map(|i| is[i] - factor * was[i]));
        let copies = plate.objects.iter().filter(|object| object.mesh == 0);
        modifiers
            .objects
            .extend(copies.map(|object| Object { mesh: modifiers.meshes.len(), ..object.clone() }));
        modifiers.meshes.push(mesh);
    }
    Ok(modifiers)
}

/// What is in a model, and whether it fits.
pub(super) fn info(
    path: &Path,
    options: &TransformOptions,
    settings: &Settings,
) -> Result<ModelInfo, JobError> {
    let Model { layout, mut reports, hint, .. } =
        model(path, mesh::load_objects(path)?, options, 1, settings)?;
    let (mesh, mut report) = match (layout.items(), reports.len()) {
        ([only], 1) => (only.mesh.clone(), reports.remove(0)),
        _ => single(path, options)?,
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
    let placed = plate::place(vec![layout], &settings.bed, &placement(settings, options));
    let advice = match &placed {
        Ok(plate) => {
            plate.notes.iter().for_each(|note| text.push_str(&format!("warning     {note}\n")));
            None
        }
        Err(error) => Some(error.to_string()),
    };
    Ok(ModelInfo {
        file: path.display().to_string(),
        mesh: serde_json::to_value(&report).unwrap_or_default(),
        text,
        objects,
        bodies,
        fits: advice.is_none(),
        advice,
    })
}

/// A file as one mesh, transformed.
fn single(path: &Path, options: &TransformOptions) -> Result<(Mesh, MeshReport), JobError> {
    let (mesh, report) = mesh::load(path)?;
    Ok((transformed(path, &transform(options), mesh)?, report))
}

fn transform(options: &TransformOptions) -> Transform {
    Transform { scale: options.scale, rotate_deg: options.rotate_deg }
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
    reach_mm(settings) + skirt_mm
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
        ((z[0].max(z[1]).max(z[2]) - z[0].min(z[1]).min(z[2])) / height_mm).ceil() as u64
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
