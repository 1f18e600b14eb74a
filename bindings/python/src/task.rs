//! What Python asks for → a job and its settings, as the program makes them.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use pathwright::job::{
    Engine, InputError, Job, JobModel, ModelFile, ModelFiles, ModelRole, ModelSource, Project, Sources,
};
use pathwright::mesh::Transform;
use pathwright::motion::PauseAt;
use pathwright::order::OrderStrategy;
use pathwright::order::compare;
use pathwright::pipeline::Pipeline;
use pathwright::presets::{Chosen, is_foreign};
use pathwright::profile::{Origin, Override, Problem, ProfileError, Resolved};
use pathwright::system;
use pathwright::{Error, Observer, SlicedJob};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;

use super::error::raised;
use super::print::Print;
use super::run::run;

/// What messages call the argument by which single settings are given.
const SETTINGS: &str = "settings";

/// A model as Python gives it.
#[derive(FromPyObject)]
pub struct Given {
    /// A file, or what messages call the contents.
    path: String,
    contents: Option<PyBackedBytes>,
    object: Option<usize>,
    scale: [f64; 3],
    rotate_deg: [f64; 3],
    at_mm: Option<[f64; 3]>,
    copies: u32,
    role: String,
    settings: Vec<(String, String)>,
}

/// Everything else that Python gives.
#[derive(FromPyObject)]
pub struct Options {
    printer: Option<String>,
    print: Option<String>,
    filament: Option<String>,
    presets: Vec<PathBuf>,
    profiles: Vec<String>,
    settings: Vec<(String, String)>,
    translate_mm: [f64; 3],
    scale_to_fit: bool,
    pauses: Vec<String>,
    color_changes: Vec<String>,
    allow_floating: bool,
    certify: bool,
    dated: Option<u64>,
    threads: usize,
}

/// A job with its settings.
#[pyclass(frozen, module = "pathwright._pathwright")]
pub struct Task {
    pub job: Arc<Job>,
    pub resolved: Arc<Resolved>,
    names: Vec<String>,
}

#[pymethods]
impl Task {
    /// What is allowed but unwise about the settings.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.resolved.warnings.iter().map(ToString::to_string).collect()
    }

    /// The hash that the G-code and the summary are kept under.
    fn key(&self, py: Python<'_>, binary: bool) -> PyResult<String> {
        let (job, resolved) = (Arc::clone(&self.job), Arc::clone(&self.resolved));
        let key = run(py, None, move |_| job.key(&resolved.settings, binary))?;
        raised(py, key)
    }

    #[pyo3(signature = (progress=None))]
    fn slice(&self, py: Python<'_>, progress: Option<&Bound<'_, PyAny>>) -> PyResult<Print> {
        let (job, resolved) = (Arc::clone(&self.job), Arc::clone(&self.resolved));
        let print = run(py, progress, move |observer| SlicedJob::new(&job, &resolved.settings, observer))?;
        Print::new(py, raised(py, print)?, &self.resolved, &self.names)
    }

    /// A row for each strategy, as JSON.
    #[pyo3(signature = (strategies, progress=None))]
    fn compare(
        &self,
        py: Python<'_>,
        strategies: Vec<String>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<String> {
        let (job, resolved) = (Arc::clone(&self.job), Arc::clone(&self.resolved));
        let strategies: Vec<OrderStrategy> =
            strategies.iter().map(|name| strategy(name)).collect::<PyResult<_>>()?;
        let rows = run(py, progress, move |observer| {
            Pipeline.compare(&job, &resolved.settings, &strategies, observer)
        })?;
        let rows = raised(py, rows)?;
        let mut json = compare::to_json(&rows);
        for (row, value) in rows.iter().zip(json.as_array_mut().into_iter().flatten()) {
            value["took_s"] = row.took_s.into();
        }
        Ok(json.to_string())
    }

    /// The contents of each model, as JSON.
    fn info(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        let (job, resolved) = (Arc::clone(&self.job), Arc::clone(&self.resolved));
        let infos = run(py, None, move |_| {
            let one = |model: &JobModel| Job { models: vec![model.clone()], ..(*job).clone() };
            let infos = job.models.iter().map(|model| Pipeline.info(&one(model), &resolved.settings));
            infos.collect::<Result<Vec<_>, _>>()
        })?;
        Ok(raised(py, infos)?.iter().map(|info| serde_json::to_string(info).unwrap_or_default()).collect())
    }
}

/// A strategy by name.
pub fn strategy(name: &str) -> PyResult<OrderStrategy> {
    ordering::chosen(OrderStrategy::ALL, "strategy", name).map_err(PyValueError::new_err)
}

/// Finds out what is asked for: reads presets and profiles, and projects.
#[pyfunction]
pub fn task(py: Python<'_>, models: Vec<Given>, options: Options) -> PyResult<Task> {
    let names = models.iter().map(|model| model.path.clone()).collect();
    let made = run(py, None, move |observer| made(models, options, observer))?;
    let (job, resolved) = raised(py, made)?;
    Ok(Task { job: Arc::new(job), resolved: Arc::new(resolved), names })
}

fn made(models: Vec<Given>, options: Options, observer: &Observer<'_>) -> Result<(Job, Resolved), Error> {
    let presets = chosen(&options)?;
    let Options { presets: places, profiles, settings, .. } = options;
    let sources = Sources { presets, profiles, overrides: overrides(settings) };
    let common = Job {
        translate_mm: options.translate_mm,
        scale_to_fit: options.scale_to_fit,
        pauses: stops(&options.pauses)?,
        color_changes: stops(&options.color_changes)?,
        dated: options.dated,
        allow_floating: options.allow_floating,
        certify: options.certify,
        threads: Some(options.threads),
        ..Job::default()
    };
    if let Some((project, files)) = project(&models, observer)? {
        let library = match project.presets.printer {
            Some(_) => Some(library(&places)?),
            None => None,
        };
        let (mut job, resolved) = sources.project(&project, &files, library.as_ref())?;
        job.translate_mm = common.translate_mm;
        job.pauses.extend(common.pauses);
        job.color_changes.extend(common.color_changes);
        job.allow_floating |= common.allow_floating;
        job.certify |= common.certify;
        (job.dated, job.threads) = (common.dated, common.threads);
        return Ok((job, resolved));
    }
    let resolved = sources.resolve(&[])?;
    let mut job = common;
    for model in models {
        let role = model.role()?;
        let model = model.into_model(&sources)?;
        match role {
            ModelRole::Part => job.models.push(model),
            ModelRole::SupportEnforcer => job.support_enforcers.push(model),
            ModelRole::SupportBlocker => job.support_blockers.push(model),
        }
    }
    Ok((job, resolved))
}

impl Given {
    fn role(&self) -> Result<ModelRole, Error> {
        match self.role.as_str() {
            "part" => Ok(ModelRole::Part),
            "support_enforcer" => Ok(ModelRole::SupportEnforcer),
            "support_blocker" => Ok(ModelRole::SupportBlocker),
            other => Err(input(
                Some(self.path.clone()),
                format!("there is no role `{other}`; there are: part, support_enforcer, support_blocker"),
            )),
        }
    }

    fn into_model(self, sources: &Sources) -> Result<JobModel, Error> {
        let own = match self.settings.is_empty() {
            true => None,
            false => Some(sources.of_object(&overrides(self.settings))?),
        };
        let source = match self.contents {
            Some(bytes) => ModelSource::Bytes { name: self.path, bytes: Arc::from(&bytes[..]) },
            None => ModelSource::Path(self.path.into()),
        };
        Ok(JobModel {
            object: self.object,
            transform: Transform { scale: self.scale, rotate_deg: self.rotate_deg },
            at_mm: self.at_mm,
            copies: self.copies,
            settings: own,
            ..JobModel::new(source)
        })
    }

    /// Whether nothing is done with it.
    fn is_plain(&self) -> bool {
        self.scale == [1.0; 3]
            && self.rotate_deg == [0.0; 3]
            && self.copies == 1
            && self.at_mm.is_none()
            && self.object.is_none()
            && self.settings.is_empty()
    }
}

/// The project, if one is given.
fn project(models: &[Given], observer: &Observer<'_>) -> Result<Option<(Project, ModelFiles)>, Error> {
    for model in models {
        let read;
        let bytes: &[u8] = match &model.contents {
            Some(bytes) if Project::is_in(bytes) => bytes,
            None if Project::is_in_file(Path::new(&model.path)) => {
                let failed = |source| InputError::Read { file: model.path.clone(), source };
                read = std::fs::read(&model.path).map_err(failed)?;
                &read
            }
            _ => continue,
        };
        let refuse = |problem: &str| Err(input(Some(model.path.clone()), problem.to_owned()));
        if models.len() > 1 {
            return refuse("a project is a plate of its own; slice it alone");
        }
        if !model.is_plain() {
            return refuse("a project says what is done with its models; give it as it is");
        }
        return Project::read(&model.path, bytes, observer);
    }
    Ok(None)
}

/// The presets that are asked for.
fn chosen(options: &Options) -> Result<Option<Chosen>, Error> {
    let (print, filament) = (options.print.as_deref(), options.filament.as_deref());
    let Some(printer) = &options.printer else {
        return match print.or(filament) {
            None => Ok(None),
            Some(name) => Err(settings(format!("preset `{name}` goes with a printer preset; name one"))),
        };
    };
    if is_foreign(Path::new(printer)) && Path::new(printer).is_file() {
        return match print.or(filament) {
            None => system::saved(printer).map(Some).map_err(settings),
            Some(other) => Err(settings(format!(
                "{printer}: holds all settings together, so that `{other}` has no place; leave it out"
            ))),
        };
    }
    let library = library(&options.presets)?;
    library.choose(printer, print, filament).map(Some).map_err(|error| settings(error.to_string()))
}

fn library(places: &[PathBuf]) -> Result<pathwright::presets::Library, Error> {
    system::library(places).map_err(|none| settings(none.to_string()))
}

fn overrides(settings: Vec<(String, String)>) -> Vec<Override> {
    settings.into_iter().map(|(key, value)| Override { key, value, option: SETTINGS }).collect()
}

fn stops(written: &[String]) -> Result<Vec<PauseAt>, Error> {
    let stop = |text: &String| text.parse::<PauseAt>().map_err(|error| input(None, error.to_string()));
    written.iter().map(stop).collect()
}

/// A model read once, for those who want bodies of it.
pub fn model_file(model: &JobModel, observer: &Observer<'_>) -> Result<Arc<ModelFile>, Error> {
    match &model.source {
        ModelSource::Read(file) => Ok(Arc::clone(file)),
        ModelSource::Bytes { name, bytes } => Ok(Arc::new(ModelFile::read(name, bytes.clone(), observer)?)),
        ModelSource::Path(path) => {
            let name = path.display().to_string();
            let failed = |source| InputError::Read { file: name.clone(), source };
            let bytes = std::fs::read(path).map_err(failed)?;
            Ok(Arc::new(ModelFile::read(&name, bytes, observer)?))
        }
    }
}

fn input(file: Option<String>, problem: String) -> Error {
    InputError::Project { file, problem }.into()
}

fn settings(message: String) -> Error {
    let problem = Problem { origin: Origin::Option("printer"), setting: None, message };
    ProfileError { problems: vec![problem] }.into()
}
