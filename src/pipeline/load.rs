//! Files → meshes on a plate.

use std::path::Path;

use crate::job::{Job, JobError, TransformOptions};
use crate::mesh::{self, Item, Mesh, MeshReport, Placement, Plate, Transform};
use crate::profile::Settings;
use crate::report::ModelInfo;

use super::parallel;

/// Header date where `SOURCE_DATE_EPOCH` gives none: the same input gives the same bytes. 2026-01-01.
const DATED: u64 = 1_767_225_600;

/// Models, placed.
pub(super) struct Loaded {
    pub plate: Plate,
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
    for loaded in read {
        let (name, mesh, report) = loaded?;
        warnings.extend(report.warnings.iter().map(|warning| format!("{name}: {warning}")));
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
    Ok(Loaded { plate, warnings })
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
    let transform = Transform { scale: [factor; 3], ..Transform::default() };
    transform.apply(mesh).map_err(|error| JobError::Input(error.to_string()))
}

fn name(path: &Path) -> String {
    path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

/// Room that skirt and brim take around the models.
fn margin_mm(settings: &Settings) -> f64 {
    let brim_mm = if settings.brim.width.0 > 0.0 { settings.brim.width.0 + settings.brim.gap.0 } else { 0.0 };
    let width_mm = settings.walls.width.0.max(settings.first_layer.width.0);
    let skirt_mm = if settings.skirt.loops > 0 {
        settings.skirt.distance.0 + f64::from(settings.skirt.loops) * width_mm
    } else {
        0.0
    };
    brim_mm + skirt_mm
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
