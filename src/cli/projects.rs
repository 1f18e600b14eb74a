//! Projects that `slice --save-project` writes.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::args::{Assignment, ObjectAssignment, SliceArgs};
use super::console;
use super::exit::{Exit, Failure, usage};
use super::plan::{Sources, Task, kept, shorthand_overrides};
use super::view::write;
use crate::job::{JobModel, ModelFile, ModelFiles, ModelRole, ModelSource, Project, ProjectModel};
use crate::observer::Observer;
use crate::pipeline::Pipeline;
use crate::plate::name_of;

/// Writes a plate as a project.
pub(super) fn save(path: &Path, task: &Task, args: &SliceArgs) -> Result<Exit, Failure> {
    let plate = &task.plate;
    let inputs: Vec<&Path> = plate.inputs.iter().map(PathBuf::as_path).collect();
    kept(&inputs, [path].into_iter())?;
    if plate.project.is_some() {
        return Err(usage(format!("{}: is a project already", inputs[0].display())));
    }
    let sources = Sources::new(&args.settings, shorthand_overrides(args)?)?;
    let mut project = Project {
        pauses: args.pause_at.iter().map(ToString::to_string).collect(),
        color_changes: args.color_change_at.iter().map(ToString::to_string).collect(),
        allow_floating: args.allow_floating,
        certify: args.certify,
        ..sources.as_project(&plate.settings)
    };
    let mut files = ModelFiles::new();
    let job = &plate.job;
    for (models, role) in [
        (&job.models, ModelRole::Part),
        (&job.support_enforcers, ModelRole::SupportEnforcer),
        (&job.support_blockers, ModelRole::SupportBlocker),
    ] {
        for model in models {
            let file = add(model, &mut files)?;
            project.models.push(ProjectModel {
                file,
                role,
                scale: model.transform.scale,
                rotate_deg: model.transform.rotate_deg,
                copies: model.copies,
                settings: if role == ModelRole::Part { own(model, args) } else { BTreeMap::new() },
                ..ProjectModel::default()
            });
        }
    }
    for ObjectAssignment { object, .. } in &args.object {
        if !job.models.iter().any(|model| is_called(model, object)) {
            let message = format!("--object {object}: a project has settings of files; name a file");
            return Err(usage(message));
        }
    }
    let job = project.job(&files, None)?;
    let settings = project.resolve(None)?.settings;
    let bytes = Pipeline.project_file(&project, &files, &job, &settings, &Observer::none())?;
    write(path, &bytes)?;
    if !args.quiet {
        console::print(&format!("{}\n", path.display()))?;
    }
    Ok(Exit::Done)
}

/// Settings of a model's own.
fn own(model: &JobModel, args: &SliceArgs) -> BTreeMap<String, String> {
    let of_it = args.object.iter().filter(|assignment| is_called(model, &assignment.object));
    of_it
        .map(|ObjectAssignment { setting: Assignment { key, value }, .. }| (key.clone(), value.clone()))
        .collect()
}

/// Whether a model is called so: without folder and ending, without folder, or whole.
fn is_called(model: &JobModel, name: &str) -> bool {
    let path = model.path();
    let file = path.file_name().unwrap_or_default().to_string_lossy();
    name == name_of(path) || name == file || name == path.display().to_string()
}

/// Reads a model's file; its name without folder.
fn add(model: &JobModel, files: &mut ModelFiles) -> Result<String, Failure> {
    let path = model.path();
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
    let bytes: Arc<[u8]> = match &model.source {
        ModelSource::Path(path) => {
            let failed = |error| Failure::new(Exit::Input, format!("{}: {error}", path.display()));
            std::fs::read(path).map_err(failed)?.into()
        }
        ModelSource::Bytes { bytes, .. } => bytes.clone(),
        ModelSource::Read(file) => file.bytes().clone(),
    };
    if let Some(known) = files.get(&name) {
        if known.bytes() != &bytes {
            return Err(usage(format!("{}: another model is called so; rename one", path.display())));
        }
        return Ok(name);
    }
    let file = ModelFile::read(&name, bytes, &Observer::none())?;
    files.insert(name.clone(), Arc::new(file));
    Ok(name)
}
