//! An upload becomes a job.

use std::collections::BTreeSet;
use std::io::Write;
use std::path::Path;

use serde_json::json;

use super::hub::Jobs;
use super::index::{Accepted, Offer};
use super::record::{Job, JobView, ModelRef, Output, Work};
use super::upload::{Received, Upload, plain_name};
use crate::job::{ModelFile, Project, ProjectModel, digest};
use crate::observer::Observer;
use crate::serve::error::{ApiError, ErrorKind};
use crate::serve::limits::shown;
use crate::serve::names::unguessable;
use crate::serve::tokens::{Client, now_s};

/// Bytes of a binary STL before its facets, and of each facet.
const STL: (u64, u64) = (84, 50);

/// Memory that a run needs at most, as estimated: this, and for each byte of its models more (3 to 5 were measured for files of
/// facets, 15 for archives).
const RUN_BYTES: u64 = 64 << 20;
const PER_BYTE: u64 = 12;
const PER_PACKED_BYTE: u64 = 80;

/// Accepts an upload; when this returns it will be done, whatever happens to the server. It blocks.
///
/// # Errors
/// A project that makes no sense, settings that are wrong, a limit.
pub fn accept(
    jobs: &Jobs,
    client: &Client,
    name: Option<String>,
    upload: Upload,
) -> Result<JobView, ApiError> {
    let Upload { project, outputs, files } = unpacked(jobs, upload)?;
    let mut project = project.unwrap_or_default();
    complete(&mut project, &files)?;
    let limits = &jobs.shared.limits;
    let facets: u64 = files.iter().filter_map(facets).sum();
    if facets > limits.facets {
        let most = limits.facets;
        return Err(ApiError::too_large(format!(
            "the models have {facets} facets; this server takes at most {most} (--max-facets)"
        )));
    }
    let need = need_bytes(files.iter().map(|file| &file.model));
    if need > jobs.budget.all_bytes() {
        let (need, most) = (need >> 20, shown(jobs.budget.all_bytes()));
        return Err(ApiError::too_large(format!(
            "these models need about {need} MiB of memory; this server gives at most {most} (--max-memory)"
        )));
    }
    let resolved = project.resolve(Some(&jobs.shared.presets))?;
    let hashes = files.iter().map(|file| (file.model.name.clone(), file.model.hash.clone())).collect();
    let key = project.key(&resolved.settings, &hashes, Some(&jobs.shared.presets))?;
    let ending = if resolved.settings.gcode.binary { "bgcode" } else { "gcode" };
    let first = project.models.first().map(|model| model.file.as_str()).unwrap_or_default();
    let gcode = Path::new(first).with_extension(ending).to_string_lossy().into_owned();

    let text = serde_json::to_vec(&project).map_err(ApiError::internal)?;
    let mut file = jobs.files.temporary()?;
    file.write_all(&text)?;
    let project_hash = digest(&text);
    let work = Work {
        seq: 0,
        client: client.0.to_string(),
        project: project_hash.clone(),
        models: files.iter().map(|file| file.model.clone()).collect(),
        model_bytes: files.iter().map(|file| file.model.bytes).sum(),
        outputs: outputs.clone(),
        attempts: 0,
    };
    let job = Job {
        seq: 0,
        client: client.0.to_string(),
        key: key.clone(),
        name: gcode,
        created_s: now_s(),
        outcome: None,
        finished_s: None,
        idempotency_key: name,
        fingerprint: digest(json!([key, outputs]).to_string().as_bytes()),
    };
    // The inputs are on the disk before the job is.
    jobs.files.keep(&project_hash, file.into_temp_path())?;
    for (done, received) in files.into_iter().enumerate() {
        if let Err(error) = jobs.files.keep(&received.model.hash, received.path) {
            work.models[..done].iter().for_each(|model| jobs.files.release(&model.hash));
            jobs.files.release(&project_hash);
            return Err(error.into());
        }
    }
    let (id, inputs) = (unguessable()?, work.clone());
    let offer = Offer { id: id.clone(), job, work };
    let mut accepted = Ok(Accepted::Known);
    let written = jobs.change(|index, changes| {
        accepted = index.accept(offer, limits, changes);
        Ok(())
    });
    if let Err(error) = written {
        jobs.index().forget(&id);
        accepted = Err(error);
    }
    // Only a new work needs what has come.
    if !matches!(accepted, Ok(Accepted::New)) {
        jobs.release(&inputs);
    }
    let metrics = &jobs.shared.metrics;
    let id = match accepted? {
        Accepted::Repeated(known) => known,
        accepted => {
            metrics.accepted.inc();
            match accepted {
                Accepted::New => jobs.wake(),
                _ => _ = metrics.known.inc(),
            }
            id
        }
    };
    jobs.index().view(&id, &client.0)
}

/// A project file that comes alone brings its project and its models.
fn unpacked(jobs: &Jobs, upload: Upload) -> Result<Upload, ApiError> {
    let (None, [only]) = (&upload.project, upload.files.as_slice()) else { return Ok(upload) };
    if !is_packed(&only.model.name) {
        return Ok(upload);
    }
    let need = need_bytes(std::iter::once(&only.model));
    let _share = jobs.budget.take(need, || !jobs.is_stopping());
    let contents = std::fs::read(&only.path)?;
    if !Project::is_in(&contents) {
        return Ok(upload);
    }
    let read = Project::read(&only.model.name, &contents, &Observer::none())?;
    let Some((project, models)) = read else { return Ok(upload) };
    let files = models.values().map(|model| received(jobs, model));
    Ok(Upload { project: Some(project), files: files.collect::<Result<_, _>>()?, ..upload })
}

/// A model of a project file, as if it had come by itself.
fn received(jobs: &Jobs, model: &ModelFile) -> Result<Received, ApiError> {
    let mut file = jobs.files.temporary()?;
    file.write_all(model.bytes())?;
    let bytes = model.bytes().len() as u64;
    let model = ModelRef { name: plain_name(model.name()), hash: model.digest().to_owned(), bytes };
    Ok(Received { part: "model", model, path: file.into_temp_path() })
}

/// Without models in the project every file is one, in the order in which they came.
fn complete(project: &mut Project, files: &[Received]) -> Result<(), ApiError> {
    let mut names = BTreeSet::new();
    if let Some(twice) = files.iter().find(|file| !names.insert(file.model.name.as_str())) {
        let name = &twice.model.name;
        let message = format!("two files are called `{name}`; give each a name of its own");
        return Err(ApiError::unusable(ErrorKind::Input, message));
    }
    if files.is_empty() {
        return Err(ApiError::usage("there is no model; send one or more as `model`"));
    }
    if project.models.is_empty() {
        let model =
            |file: &Received| ProjectModel { file: file.model.name.clone(), ..ProjectModel::default() };
        project.models = files.iter().map(model).collect();
    }
    match project.models.iter().find(|model| !names.contains(model.file.as_str())) {
        None => Ok(()),
        Some(model) => {
            let known = names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
            let message = format!(
                "the project has a model of the file `{}`, which did not come; {known} did",
                model.file
            );
            Err(ApiError::unusable(ErrorKind::Input, message))
        }
    }
}

/// Facets of a file that says so before it is read: a binary STL.
fn facets(file: &Received) -> Option<u64> {
    let bytes = file.model.bytes.checked_sub(STL.0)?;
    (bytes.is_multiple_of(STL.1) && is_stl(&file.model.name)).then_some(bytes / STL.1)
}

fn is_packed(name: &str) -> bool {
    name.to_ascii_lowercase().ends_with(".3mf")
}

fn is_stl(name: &str) -> bool {
    name.to_ascii_lowercase().ends_with(".stl")
}

/// Memory that models are estimated to need.
pub fn need_bytes<'a>(models: impl Iterator<Item = &'a ModelRef>) -> u64 {
    let need =
        |model: &ModelRef| model.bytes * if is_packed(&model.name) { PER_PACKED_BYTE } else { PER_BYTE };
    RUN_BYTES + models.map(need).sum::<u64>()
}

/// What is made while a job runs, without what always is.
pub fn extras(outputs: &[Output]) -> BTreeSet<Output> {
    outputs.iter().copied().filter(|output| !matches!(output, Output::Gcode | Output::Summary)).collect()
}
