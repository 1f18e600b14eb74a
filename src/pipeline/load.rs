//! Files → meshes on a plate.

use std::path::{Path, PathBuf};

use crate::job::{Job, JobError, TransformOptions};
use crate::limits;
use crate::mesh::{self, Item, Mesh, MeshReport, Object, Placement, Plate, Transform};
use crate::profile::{LayerSettings, Settings};
use crate::report::ModelInfo;
use crate::units::Mm;

use super::parallel;
use super::supports::REACH_MM as SUPPORT_REACH_MM;

/// Header date where `SOURCE_DATE_EPOCH` gives none: the same input gives the same bytes. 2026-01-01.
const DATED: u64 = 1_767_225_600;

/// Models, placed.
pub(super) struct Loaded {
    pub plate: Plate,
    /// Where support is enforced and where it is blocked: bodies on the same plate.
    pub wishes: [Plate; 2],
    pub warnings: Vec<String>,
}

/// Reads, transforms and places the models of a job.
pub(super) fn plate(job: &Job, settings: &Settings) -> Result<Loaded, JobError> {
    let read = parallel::map(job.models.len(), |i| {
        let (mesh, report) = model(&job.models[i], &job.transform)?;
        Ok::<_, JobError>((name(&job.models[i]), mesh, report))
    });
    let mut items = Vec::new();
    let mut warnings = Vec::new();
    let mut first_box = None;
    for loaded in read {
        let (name, mesh, report) = loaded?;
        warnings.extend(report.warnings.iter().map(|warning| format!("{name}: {warning}")));
        first_box.get_or_insert(mesh.bounds());
        let mesh = if job.transform.scale_to_fit { fitted(mesh, settings)? } else { mesh };
        items.push(Item { name, mesh, copies: job.copies as usize });
    }
    let placement = Placement {
        margin_mm: margin_mm(settings),
        shift_mm: job.transform.translate_mm,
        ..Placement::default()
    };
    let plate = mesh::place(items, &settings.bed, &placement)
        .map_err(|error| JobError::DoesNotFit(error.to_string()))?;
    check_size(&plate, &settings.layer)?;
    let wished = |files| wished(files, job, first_box, &plate);
    let wishes = [wished(&job.support_enforcers)?, wished(&job.support_blockers)?];
    Ok(Loaded { plate, wishes, warnings })
}

/// Bodies taken along by the first model, which was in `first_box` before it was fitted and placed.
fn wished(
    files: &[PathBuf],
    job: &Job,
    first_box: Option<[[f64; 3]; 2]>,
    plate: &Plate,
) -> Result<Plate, JobError> {
    let mut wished = Plate { meshes: Vec::new(), objects: Vec::new() };
    let (Some([was, was_to]), Some(first)) = (first_box, plate.meshes.first()) else { return Ok(wished) };
    let [is, is_to] = first.bounds();
    let factor = (0..3).map(|i| (is_to[i] - is[i]) / (was_to[i] - was[i])).fold(0.0, f64::max);
    for file in files {
        let (mesh, _) = model(file, &job.transform)?;
        let mut mesh = scaled(mesh, factor)?;
        mesh.shift([0, 1, 2].map(|i| is[i] - factor * was[i]));
        let copies = plate.objects.iter().filter(|object| object.mesh == 0);
        wished.objects.extend(copies.map(|object| Object { mesh: wished.meshes.len(), ..object.clone() }));
        wished.meshes.push(mesh);
    }
    Ok(wished)
}

/// What is in a model, and whether it fits.
pub(super) fn info(
    path: &Path,
    options: &TransformOptions,
    settings: &Settings,
) -> Result<ModelInfo, JobError> {
    let (mesh, report) = model(path, options)?;
    let mesh = if options.scale_to_fit { fitted(mesh, settings)? } else { mesh };
    let item = Item { name: name(path), mesh, copies: 1 };
    let placement =
        Placement { margin_mm: margin_mm(settings), shift_mm: options.translate_mm, ..Placement::default() };
    let advice = mesh::place(vec![item], &settings.bed, &placement).err().map(|error| error.to_string());
    Ok(ModelInfo {
        file: path.display().to_string(),
        mesh: serde_json::to_value(&report).unwrap_or_default(),
        text: report.to_string(),
        fits: advice.is_none(),
        advice,
    })
}

fn model(path: &Path, options: &TransformOptions) -> Result<(Mesh, MeshReport), JobError> {
    let (mesh, report) = mesh::load(path).map_err(|error| JobError::Input(error.to_string()))?;
    let transform = Transform { scale: options.scale, rotate_deg: options.rotate_deg };
    let mesh =
        transform.apply(mesh).map_err(|error| JobError::Input(format!("{}: {error}", path.display())))?;
    Ok((mesh, report))
}

/// Shrunk to the bed where it is larger.
fn fitted(mesh: Mesh, settings: &Settings) -> Result<Mesh, JobError> {
    let factor = mesh::fit_factor(&mesh, &settings.bed, margin_mm(settings));
    scaled(mesh, factor)
}

fn scaled(mesh: Mesh, factor: f64) -> Result<Mesh, JobError> {
    let transform = Transform { scale: [factor; 3], ..Transform::default() };
    transform.apply(mesh).map_err(|error| JobError::Input(error.to_string()))
}

fn name(path: &Path) -> String {
    path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

/// Room that support, raft, brim and skirt take around the models.
fn margin_mm(settings: &Settings) -> f64 {
    let support_mm = if settings.support.enabled { SUPPORT_REACH_MM } else { 0.0 };
    let raft_mm = if settings.raft.layers > 0 { settings.raft.margin.0 } else { 0.0 };
    let brim_mm = if settings.brim.width.0 > 0.0 { settings.brim.width.0 + settings.brim.gap.0 } else { 0.0 };
    let width_mm = settings.walls.width.0.max(settings.first_layer.width.0);
    let skirt_mm = if settings.skirt.loops > 0 {
        settings.skirt.distance.0 + f64::from(settings.skirt.loops) * width_mm
    } else {
        0.0
    };
    brim_mm.max(support_mm + raft_mm) + skirt_mm
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
    Err(JobError::DoesNotFit(format!(
        "on its raft the print is {top_mm:.2} mm high, the printer {bed_mm} mm; give a smaller raft.layers or --scale"
    )))
}

/// Whether the plate can be cut into so many layers.
pub(super) fn check_size(plate: &Plate, settings: &LayerSettings) -> Result<(), JobError> {
    let (first_mm, height_mm) = (settings.first_height.0, settings.height.0);
    let top_mm = plate.meshes.iter().map(|mesh| mesh.bounds()[1][2]).fold(0.0, f64::max);
    let layers = (top_mm - first_mm).max(0.0) / height_mm + 1.0;
    if layers > limits::LAYERS as f64 {
        let most = limits::LAYERS;
        return Err(JobError::Input(format!(
            "{layers:.0} layers; at most {most} are made: choose a larger layer.height, or check the model's unit"
        )));
    }
    let crossed = |mesh: &Mesh, triangle: &[u32; 3]| {
        let z = triangle.map(|v| mesh.vertices()[v as usize][2]);
        ((z[0].max(z[1]).max(z[2]) - z[0].min(z[1]).min(z[2])) / height_mm).ceil() as u64
    };
    let crossings: u64 =
        plate.meshes.iter().flat_map(|mesh| mesh.triangles().iter().map(|t| crossed(mesh, t))).sum();
    let too_large = |problem| {
        JobError::Input(format!(
            "the print is too large: {problem}; choose a larger layer.height or reduce the number of facets"
        ))
    };
    if crossings > limits::CROSSINGS {
        let millions = |count: u64| count / 1_000_000;
        let (crossings, most) = (millions(crossings), millions(limits::CROSSINGS));
        return Err(too_large(format!(
            "layers cross {crossings} million facets; at most {most} are allowed"
        )));
    }
    limits::room(crossings * limits::BYTES_PER_CROSSING).map_err(too_large)
}

/// Seconds since 1970 for the header.
pub(super) fn dated() -> u64 {
    std::env::var("SOURCE_DATE_EPOCH").ok().and_then(|text| text.parse().ok()).unwrap_or(DATED)
}

/// No layer has a section.
pub(super) fn nothing_to_print() -> JobError {
    JobError::Input(
        "there is nothing to print: no layer's middle lies inside the model; choose a smaller layer.height"
            .into(),
    )
}
