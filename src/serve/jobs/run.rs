//! One run: from the inputs of a work to its files.

use std::fs;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Instant;

use tempfile::TempPath;

use super::accept::{extras, need_bytes};
use super::files::{GCODE, SETTINGS, SUMMARY};
use super::hub::Jobs;
use super::index::Turn;
use super::record::Kept;
use super::render;
use crate::job::{Engine, InputError, Job, JobError, ModelFile, ModelFiles, Project};
use crate::observer::Observer;
use crate::output::Output;
use crate::pipeline::Pipeline;
use crate::profile::{Settings, binary_metadata};
use crate::report::Summary;
use crate::serve::error::{ErrorKind, Problem};

/// How a run ended.
#[derive(Debug)]
pub enum Ended {
    /// The files are there.
    Done(Kept),
    /// It made nothing.
    Failed(Problem),
    /// Nobody wants it any more, or the server ends.
    Stopped,
}

/// Does what is to be done, with the threads of the caller.
pub fn run(jobs: &Jobs, turn: &Turn) -> Ended {
    let is_wanted = || !turn.signs.cancelled.load(Ordering::Relaxed) && !jobs.is_stopping();
    let Some(_share) = jobs.budget.take(need_bytes(turn.work.models.iter()), is_wanted) else {
        return Ended::Stopped;
    };
    let limits = &jobs.shared.limits;
    let deadline = Instant::now() + limits.job_time;
    let observer = Observer::none()
        .on_progress(|done, of| turn.signs.set_progress(done, of))
        .cancelled_when(|| !is_wanted() || Instant::now() > deadline);
    let limit = |message: String| Problem { kind: ErrorKind::Limit, message, object: None, key: None };
    match made(jobs, turn, &observer) {
        Ok(kept) => Ended::Done(kept),
        Err(Failure::Job(JobError::Cancelled)) if !is_wanted() => Ended::Stopped,
        Err(Failure::Job(JobError::Cancelled)) => {
            let most = limits.job_time.as_secs();
            Ended::Failed(limit(format!("it takes longer than {most} s, which is the most (--max-job-time)")))
        }
        Err(Failure::Job(error)) => Ended::Failed(Problem::from(&error)),
        Err(Failure::Facets(facets)) => {
            let most = limits.facets;
            Ended::Failed(limit(format!(
                "the models have {facets} facets; this server takes at most {most} (--max-facets)"
            )))
        }
        Err(Failure::Disk(error)) => Ended::Failed(Problem {
            kind: ErrorKind::Internal,
            message: format!("the disk of this server: {error}"),
            object: None,
            key: None,
        }),
    }
}

/// Why nothing was made.
enum Failure {
    Job(JobError),
    Facets(u64),
    Disk(std::io::Error),
}

impl<E: Into<JobError>> From<E> for Failure {
    fn from(error: E) -> Self {
        Self::Job(error.into())
    }
}

fn made(jobs: &Jobs, turn: &Turn, observer: &Observer<'_>) -> Result<Kept, Failure> {
    let library = Some(&*jobs.shared.presets);
    let project = fs::read(jobs.files.input(&turn.work.project)).map_err(Failure::Disk)?;
    let project: Project = serde_json::from_slice(&project)
        .map_err(|error| InputError::Project { file: None, problem: error.to_string() })?;
    let settings = project.resolve(library)?.settings;
    let files = models(jobs, turn, observer)?;
    let job = project.job(&files, library)?;
    let (path, summary) = sliced(jobs, &turn.key, &job, &settings, observer)?;
    drop((job, files));

    let gcode_bytes = fs::metadata(&path).map_err(Failure::Disk)?.len();
    let summary_text = serde_json::to_vec(&summary).unwrap_or_default();
    let settings_text = serde_json::to_vec(&settings).unwrap_or_default();
    let keep = || {
        jobs.files.write_result(&turn.key, SUMMARY, &summary_text)?;
        jobs.files.write_result(&turn.key, SETTINGS, &settings_text)?;
        jobs.files.persist_result(&turn.key, GCODE, path)
    };
    keep().map_err(Failure::Disk)?;
    let extras = extras(&turn.work.outputs);
    if !extras.is_empty() {
        let title = turn.work.models.first().map_or("", |model| model.name.as_str());
        render::all(&jobs.files, &turn.key, title, &extras, observer)?;
    }
    Ok(Kept {
        file_name: summary.file_name.as_deref().and_then(|name| safe_name(name, settings.gcode.binary)),
        binary: settings.gcode.binary,
        gcode_bytes,
        bytes: jobs.files.result_bytes(&turn.key),
        runs: turn.work.attempts,
        used: 0,
    })
}

/// The models, read and repaired.
fn models(jobs: &Jobs, turn: &Turn, observer: &Observer<'_>) -> Result<ModelFiles, Failure> {
    let (mut files, mut facets) = (ModelFiles::new(), 0);
    for model in &turn.work.models {
        let contents = fs::read(jobs.files.input(&model.hash)).map_err(Failure::Disk)?;
        let file = ModelFile::read(&model.name, contents, observer)?;
        facets += file.objects().iter().map(|object| object.mesh.triangles().len() as u64).sum::<u64>();
        if facets > jobs.shared.limits.facets {
            return Err(Failure::Facets(facets));
        }
        files.insert(model.name.clone(), Arc::new(file));
    }
    Ok(files)
}

/// The G-code as a temporary file, and what it came to.
fn sliced(
    jobs: &Jobs,
    key: &str,
    job: &Job,
    settings: &Settings,
    observer: &Observer<'_>,
) -> Result<(TempPath, Summary), Failure> {
    let path = jobs.files.temporary_path(key).map_err(Failure::Disk)?;
    let mut output = match settings.gcode.binary {
        true => Output::create_binary(&path, binary_metadata(settings))?,
        false => Output::create(&path)?,
    };
    let mut summary = Pipeline.slice(job, settings, &mut output, observer)?;
    output.commit()?;
    summary.models = job.models.iter().map(|model| model.path().display().to_string()).collect();
    summary.output = GCODE.to_owned();
    Ok((path, summary))
}

/// A name that the settings have chosen, as one of a file.
fn safe_name(name: &str, binary: bool) -> Option<String> {
    let safe = |c: char| if c.is_control() || "/\\:*?\"<>|".contains(c) { '_' } else { c };
    let safe: String = name.trim().chars().map(safe).take(200).collect();
    let stem = Path::new(&safe).file_stem()?.to_string_lossy().into_owned();
    Some(format!("{stem}.{}", if binary { "bgcode" } else { "gcode" }))
}
