//! What a session does beside its caller: one revision after the other.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::event::{Before, Done, Event, Failed};
use super::options::{Failure, Options};
use super::resolved::Resolved;
use super::results::Results;
use super::slicing::{Slicing, Step};
use super::state::{State, Wanted};
use crate::job::{Job, JobError, ModelFile, PresetNames, Project};
use crate::mesh::Mesh;
use crate::pipeline::StageCache;
use crate::presets::{Chosen, Library};
use crate::profile::{self, Settings};
use crate::report::Summary;

/// What its work shares with a session.
pub(super) struct Shared {
    pub options: Options,
    /// Presets that projects may name.
    library: Mutex<Option<Arc<Library>>>,
    state: Mutex<State>,
    /// Revisions before this one are overtaken; asked by slicings without a lock.
    pub first: AtomicU64,
    /// What slicings left for the next ones; only whoever slices takes it.
    cache: Mutex<Cache>,
}

#[derive(Default)]
struct Cache {
    stages: StageCache,
    /// Of which presets, by which names.
    chosen: Option<(Arc<Library>, PresetNames, Arc<Chosen>)>,
}

/// About how many bytes a model takes: its file, and the repaired meshes.
pub(super) fn bytes_of(file: &ModelFile) -> usize {
    let meshes = file.objects().iter().map(|object| &object.mesh);
    let meshes: usize = meshes.map(|mesh| 24 * mesh.vertices().len() + 24 * mesh.triangles().len()).sum();
    file.bytes().len() + meshes
}

impl Shared {
    pub fn new(options: Options) -> Self {
        let library = Mutex::new(options.library.clone());
        Self { options, library, state: Mutex::default(), first: AtomicU64::new(0), cache: Mutex::default() }
    }

    pub fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub fn library(&self) -> Option<Arc<Library>> {
        self.library.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Takes other presets in place of those that there are; what is sliced next is of them.
    pub fn set_library(&self, library: Arc<Library>) {
        *self.library.lock().unwrap_or_else(PoisonError::into_inner) = Some(library);
    }

    pub fn check_room(&self, bytes: usize) -> Result<(), Failure> {
        let held: usize = self.state().files.values().map(|file| bytes_of(file)).sum();
        let most = self.options.models_bytes;
        match held.saturating_add(bytes) > most {
            true => Err(Failure::Limit(format!(
                "the models of this plate would take more than {} MB of memory, which is the most; remove some",
                most >> 20
            ))),
            false => Ok(()),
        }
    }

    pub fn with_mesh<T>(
        &self,
        file: &str,
        object: usize,
        give: impl FnOnce(&Mesh) -> T,
    ) -> Result<T, Failure> {
        let found = self.state().files.get(file).cloned();
        let Some(found) = found else { return Err(Failure::Missing { what: format!("model {file}") }) };
        match found.objects().get(object) {
            Some(model) => Ok(give(&model.mesh)),
            None => Err(Failure::Missing { what: format!("object {object} in {file}") }),
        }
    }

    pub fn want(self: &Arc<Self>, projects: Vec<Arc<Project>>) -> u64 {
        let mut state = self.state();
        let first = state.want(projects);
        self.first.fetch_max(first, Ordering::Relaxed);
        let begins = !state.is_running && !state.is_closed;
        state.is_running |= begins;
        drop(state);
        if begins {
            self.begin();
        }
        first
    }

    fn begin(self: &Arc<Self>) {
        let shared = self.clone();
        (self.options.spawn)(Box::new(move || shared.work()));
    }

    /// Slices what is wanted, one revision, and has the next one begun: between two, others that share the pool may have
    /// their turn.
    fn work(self: &Arc<Self>) {
        let next = self.state().wanted.pop_front();
        if let Some(wanted) = next {
            let mut cache = std::mem::take(&mut *self.cache.lock().unwrap_or_else(PoisonError::into_inner));
            let outcome = catch_unwind(AssertUnwindSafe(|| self.slice(&wanted, &mut cache)));
            match outcome {
                Ok(()) => {
                    if cache.stages.bytes() > self.options.kept_bytes {
                        cache.stages = StageCache::default();
                    }
                    *self.cache.lock().unwrap_or_else(PoisonError::into_inner) = cache;
                }
                // What was kept may be half done.
                Err(_) => self.state().tell(Event::Failed(Box::new(Failed::internal(wanted.revision)))),
            }
        }
        let mut state = self.state();
        state.is_running = !state.wanted.is_empty();
        let goes_on = state.is_running;
        drop(state);
        if goes_on {
            self.begin();
        }
    }

    fn slice(&self, wanted: &Wanted, cache: &mut Cache) {
        let Wanted { revision, project } = wanted;
        let Some((job, settings)) = self.resolve(*revision, project, cache) else { return };
        let is_over = || self.first.load(Ordering::Relaxed) > *revision;
        let clock = self.options.clock;
        let slicing = Slicing {
            revision: *revision,
            project,
            job: &job,
            settings: &settings,
            is_over: &is_over,
            clock,
        };
        let tell = |step: Step| {
            let mut state = self.state();
            match step {
                Step::Placed(placed) => state.tell(Event::Placed(Box::new(placed))),
                Step::Progress(progress) => state.tell(Event::Progress(progress)),
                Step::Walls(walls) => {
                    if !is_over() {
                        let packed = Some(walls.packed.clone());
                        let results = Results { revision: *revision, walls: packed, ..Results::default() };
                        state.keep(results, self.options.kept_bytes);
                    }
                    state.tell(Event::Walls(walls));
                }
            }
        };
        match slicing.run(&mut cache.stages, &tell) {
            Ok(results) => {
                let done = self.done(&results, project, &job, &settings);
                let mut state = self.state();
                if is_over() {
                    return;
                }
                let before = state.finished_before(*revision).and_then(|before| before.summary.as_deref());
                let before = before.map(Before::of);
                state.keep(results, self.options.kept_bytes);
                match done {
                    Ok(done) => state.tell(Event::Done(Box::new(Done { before, ..done }))),
                    Err(error) => state.tell(Event::Failed(Box::new(Failed::of(*revision, &error)))),
                }
            }
            Err(JobError::Cancelled) => {}
            Err(error) => self.state().tell(Event::Failed(Box::new(Failed::of(*revision, &error)))),
        }
    }

    /// Settings and job of a project, if nothing must be mended; tells of them.
    fn resolve(&self, revision: u64, project: &Project, cache: &mut Cache) -> Option<(Job, Settings)> {
        let chosen = match self.chosen(project, cache) {
            Ok(chosen) => chosen,
            Err(error) => {
                self.state().tell(Event::Resolved(Box::new(Resolved::failed(revision, &error))));
                return None;
            }
        };
        let (mut resolved, sound) = Resolved::of(revision, project, chosen.as_deref());
        let files = self.state().files.clone();
        let job = match (&sound, project.models.is_empty()) {
            (Some(_), false) => Some(project.job_with(&files, chosen.as_deref(), &[])),
            _ => None,
        };
        let fault = match &job {
            Some(Err(JobError::Settings(error))) => {
                resolved.add_of_models(project, error, chosen.as_deref());
                None
            }
            Some(Err(error)) => Some(Failed::of(revision, error)),
            _ => None,
        };
        self.state().tell(Event::Resolved(Box::new(resolved)));
        if let Some(fault) = fault {
            self.state().tell(Event::Failed(Box::new(fault)));
        }
        Some((job?.ok()?, sound?.settings))
    }

    /// The presets that a project names; looked up once.
    fn chosen(
        &self,
        project: &Project,
        cache: &mut Cache,
    ) -> Result<Option<Arc<Chosen>>, profile::ProfileError> {
        let Some(library) = self.library() else { return Ok(project.chosen(None)?.map(Arc::new)) };
        if let Some((of, names, chosen)) = &cache.chosen
            && Arc::ptr_eq(of, &library)
            && *names == project.presets
        {
            return Ok(Some(chosen.clone()));
        }
        let chosen = project.chosen(Some(&library))?.map(Arc::new);
        cache.chosen = chosen.clone().map(|chosen| (library, project.presets.clone(), chosen));
        Ok(chosen)
    }

    fn done(
        &self,
        results: &Results,
        project: &Project,
        job: &Job,
        settings: &Settings,
    ) -> Result<Done, JobError> {
        let files = self.state().files.clone();
        let command = project.command(&files);
        let summary = results.summary.as_deref().cloned().unwrap_or_default();
        Ok(Done {
            revision: results.revision,
            name: results.name.clone(),
            bytes: results.gcode.as_ref().map_or(0, |gcode| gcode.len()),
            key: job.key(settings, results.binary.is_some())?,
            project_needed: command.is_none(),
            command,
            before: None,
            warnings: summary.warnings.clone(),
            summary: Summary { layers: Vec::new(), ..summary },
        })
    }
}
